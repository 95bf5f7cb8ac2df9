// Turns the pictures of a page of raydiff explain: drag to turn, wheel to come closer, double click
// to start again; a click on a line of the legend hides what it names.
for (const figure of document.querySelectorAll('figure.view')) {
  const view = JSON.parse(figure.querySelector('script').textContent);
  const svg = figure.querySelector('svg');
  const title = svg.querySelector('title').outerHTML;
  const size = svg.viewBox.baseVal.width;
  let turn = view.turn, zoom = 1, from = null;
  const along = (row, p) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2];
  const draw = () => {
    const scale = (0.5 * size - 5) / Math.sqrt(3) * zoom, middle = size / 2;
    const at = p => (middle + scale * along(turn[0], p)).toFixed(1) + ',' + (middle - scale * along(turn[1], p)).toFixed(1);
    const depth = s => s.role === 'hit' ? 12 : s.role === 'ray' ? 11 :
      s.corners.reduce((sum, p) => sum + along(turn[2], p), 0) / s.corners.length;
    svg.innerHTML = title + [...view.shapes].sort((a, b) => depth(a) - depth(b)).map(s => {
      if (s.role === 'hit') {
        const [x, y] = at(s.corners[0]).split(',');
        return `<circle class="hit" cx="${x}" cy="${y}" r="4"/>`;
      }
      return `<poly${s.role === 'ray' ? 'line' : 'gon'} class="${s.role}" points="${s.corners.map(at).join(' ')}"/>`;
    }).join('');
  };
  // Rows of the turn, after a turn by an angle in the plane of two of them.
  const rotate = (a, b, angle) => {
    const c = Math.cos(angle), s = Math.sin(angle);
    const row = turn.map(r => [...r]);
    for (let k = 0; k < 3; k++) {
      row[a][k] = c * turn[a][k] + s * turn[b][k];
      row[b][k] = c * turn[b][k] - s * turn[a][k];
    }
    turn = row;
  };
  svg.addEventListener('pointerdown', e => { from = [e.clientX, e.clientY]; svg.setPointerCapture(e.pointerId); });
  svg.addEventListener('pointerup', () => { from = null; });
  svg.addEventListener('pointermove', e => {
    if (!from) return;
    rotate(0, 2, (from[0] - e.clientX) * 0.008);
    rotate(1, 2, (e.clientY - from[1]) * 0.008);
    from = [e.clientX, e.clientY];
    draw();
  });
  svg.addEventListener('wheel', e => {
    e.preventDefault();
    zoom = Math.min(50, Math.max(0.2, zoom * Math.exp(-0.001 * e.deltaY)));
    draw();
  }, { passive: false });
  svg.addEventListener('dblclick', () => { turn = view.turn; zoom = 1; draw(); });
}
for (const line of document.querySelectorAll('ul.legend li'))
  line.addEventListener('click', () => {
    line.classList.toggle('off');
    document.body.classList.toggle('no-' + line.dataset.role);
  });
