// The view of a page of raydiff web: triangles, the ray, the boxes on its way, the node that turned it away, the hits.
// Drag or arrows turn, wheel or + and - come closer, [ and ] walk the boxes, 0 starts again.

const pageData = JSON.parse(document.getElementById('data').textContent);

// Words of base64, as the program wrote them.
function wordsOf(text) {
    const bytes = atob(text);
    const out = new Uint8Array(bytes.length);
    for (let i = 0; i < bytes.length; i++)
        out[i] = bytes.charCodeAt(i);
    return new Uint32Array(out.buffer);
}

function floatsOf(text) {
    return new Float32Array(wordsOf(text).buffer);
}

// A float of the JSON of raydiff explain, by its bits.
function floatOf(json) {
    return new Float32Array(Uint32Array.of(Number(json.bits)).buffer)[0];
}

const viewOf = (() => {
    const explained = pageData.explained, canvas = document.getElementById('view');
    const context = canvas.getContext('2d');
    const corners = floatsOf(pageData.triangles), triangles = corners.length / 9;
    const ray = floatsOf(pageData.rays).subarray(8 * pageData.shown, 8 * pageData.shown + 8);
    const origin = [...ray.subarray(0, 3)], direction = [...ray.subarray(4, 7)];
    const colours = { other: '#b9c2cb', expected: '#e08a00', answered: '#7a4fc0', way: '#5b6670', chosen: '#1f77b4',
                      away: '#c4262e', ray: '#0b3d91', exact: '#16803c' };
    const key = { other: 'other triangles', expected: 'the triangle to be hit', answered: 'the triangle that was answered',
                  way: 'boxes on the way', chosen: 'the box that is chosen', away: 'the node where the way ends',
                  ray: 'the ray', exact: 'the exact hit' };
    const DRAWN = 4000; // triangles, those nearest to what is looked at

    const boxes = explained.way.slice(0, explained.way.length ? explained.last + 1 : 0).map((step) => ({
        node: step.node, tested: step.tested, hit: step.hit,
        lo: step.lo.map((bound) => floatOf(bound.decoded)), hi: step.hi.map((bound) => floatOf(bound.decoded)),
        gap: Math.max(...[...step.lo, ...step.hi].map((bound) =>
            bound.fault === 'ok' ? 0 : Math.abs(floatOf(bound.decoded) - floatOf(bound.exact)))),
    }));
    const drawable = boxes.map((box) => [...box.lo, ...box.hi].every(Number.isFinite));
    const rayIsFinite = [...origin, ...direction].every(Number.isFinite);
    const expected = explained.judgement.expected ?? explained.truth.prim;
    const answered = explained.finished && explained.answer ? explained.answer.prim : null;
    const at = (t) => origin.map((x, k) => x + t * direction[k]);
    const exact = explained.truth.prim !== null && rayIsFinite && Number.isFinite(explained.truth.t_lo)
        ? at(0.5 * (explained.truth.t_lo + explained.truth.t_hi)) : null;

    const corner = (triangle, c) => [0, 1, 2].map((k) => corners[9 * triangle + 3 * c + k]);
    const along = (row, p) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2];
    const cross = (a, b) => [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    function unit(v) {
        const most = Math.max(...v.map(Math.abs)) || 1, w = v.map((x) => x / most), length = Math.hypot(...w) || 1;
        return w.map((x) => x / length);
    }

    // --- where it looks ---------------------------------------------------------------------------------------------

    function frame(points) {
        const lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
        for (const p of points)
            for (let k = 0; k < 3; k++) {
                lo[k] = Math.min(lo[k], p[k]);
                hi[k] = Math.max(hi[k], p[k]);
            }
        const most = Math.max(...lo.map((x, k) => 0.5 * hi[k] - 0.5 * x));
        return { focus: lo.map((x, k) => (Number.isFinite(x) ? 0.5 * x + 0.5 * hi[k] : 0)),
                 radius: most > 0 && Number.isFinite(most) ? 1.25 * most : 1 };
    }

    function pointsOf(prims) {
        return prims.filter((prim) => prim !== null && prim < triangles)
            .flatMap((prim) => [0, 1, 2].map((c) => corner(prim, c)));
    }

    const looks = {
        scene: () => frame(pointsOf([...Array(triangles).keys()])),
        node: () => {
            const last = boxes.length - 1;
            const points = [...pointsOf([expected, answered]), ...(exact ? [exact] : []),
                            ...(last >= 0 && drawable[last] ? [boxes[last].lo, boxes[last].hi] : [])];
            return points.length ? frame(points) : looks.scene();
        },
        hit: () => {
            const around = looks.node(), gap = boxes.length ? boxes[boxes.length - 1].gap : 0;
            if (!exact)
                return around;
            return { focus: exact, radius: gap > 0 && Number.isFinite(gap) ? Math.min(around.radius, 2.5 * gap)
                                                                           : around.radius / 50 };
        },
    };

    function firstTurn() {
        const ahead = rayIsFinite ? unit(direction) : [0, 0, 1];
        const up = Math.abs(ahead[1]) < 0.9 ? [0, 1, 0] : [0, 0, 1], side = unit(cross(ahead, up));
        const toEye = unit(side.map((x, k) => 0.85 * x - 0.4 * ahead[k] + 0.35 * up[k]));
        const right = unit(cross(up, toEye));
        return [right, cross(toEye, right), toEye];
    }

    let turn, look, zoom, chosen;

    function start(kind) {
        turn = firstTurn();
        look = looks[kind]();
        zoom = 1;
        chosen = boxes.length - 1;
    }

    // --- drawing ----------------------------------------------------------------------------------------------------

    function place(p) {
        const scale = 0.4 * Math.min(canvas.width, canvas.height) / look.radius * zoom;
        const d = p.map((x, k) => x - look.focus[k]);
        return [0.5 * canvas.width + scale * along(turn[0], d), 0.5 * canvas.height - scale * along(turn[1], d)];
    }

    const depth = (p) => along(turn[2], p.map((x, k) => x - look.focus[k]));

    function path(points, close) {
        context.beginPath();
        points.forEach((p, i) => (i ? context.lineTo(...p) : context.moveTo(...p)));
        if (close)
            context.closePath();
    }

    function drawTriangle(prim, role) {
        path([0, 1, 2].map((c) => place(corner(prim, c))), true);
        context.fillStyle = context.strokeStyle = colours[role];
        context.globalAlpha = role === 'other' ? 0.25 : 0.6;
        context.fill();
        context.globalAlpha = 1;
        context.lineWidth = role === 'other' ? 0.5 : 1.5;
        context.stroke();
    }

    function drawBox(box, colour, width) {
        const of = (i) => place([0, 1, 2].map((k) => (i >> k & 1 ? box.hi : box.lo)[k]));
        context.strokeStyle = colour;
        context.lineWidth = width;
        for (let i = 0; i < 8; i++)
            for (let k = 0; k < 3; k++)
                if (!(i >> k & 1)) {
                    path([of(i), of(i | 1 << k)]);
                    context.stroke();
                }
    }

    function dot(p, colour) {
        context.beginPath();
        context.arc(...place(p), 5, 0, 2 * Math.PI);
        context.fillStyle = colour;
        context.fill();
    }

    function drawRay() {
        const far = Math.hypot(...origin.map((x, k) => x - look.focus[k])) + 8 * look.radius;
        const ends = [ray[3], Math.min(ray[7], far / (Math.hypot(...direction) || 1))];
        path(ends.map((t) => place(at(t))));
        context.strokeStyle = colours.ray;
        context.lineWidth = 2.5;
        context.stroke();
    }

    function nearest() {
        const all = [...Array(triangles).keys()].filter((prim) => prim !== expected && prim !== answered);
        const middle = new Map(all.map((prim) => {
            const points = [0, 1, 2].map((c) => corner(prim, c));
            return [prim, [0, 1, 2].map((k) => (points[0][k] + points[1][k] + points[2][k]) / 3)];
        }));
        if (all.length > DRAWN) {
            const off = (prim) => Math.hypot(...middle.get(prim).map((x, k) => x - look.focus[k]));
            all.sort((a, b) => off(a) - off(b)).length = DRAWN;
        }
        return all.sort((a, b) => depth(middle.get(a)) - depth(middle.get(b)));
    }

    function say(drawn) {
        const box = boxes[chosen], left = triangles - drawn;
        const told = box ? `box ${chosen + 1} of ${boxes.length}: node ${box.node}, ` +
            (box.tested ? (box.hit ? 'met by the ray' : 'the ray is turned away') : 'never reached') : 'no boxes are known';
        document.getElementById('shown').textContent =
            `${drawn} triangles${left ? `, ${left} others are left out` : ''}; ${told}`;
        Object.assign(canvas.dataset, { focus: look.focus.join(' '), radius: look.radius, zoom, turn: turn.flat().join(' '),
                                        drawn, boxes: boxes.length, chosen });
    }

    function draw() {
        context.globalAlpha = 1;
        context.fillStyle = '#ffffff';
        context.fillRect(0, 0, canvas.width, canvas.height);
        const others = nearest(), special = [[answered, 'answered'], [expected, 'expected']]
            .filter(([prim], i) => prim !== null && prim < triangles && (i || prim !== expected));
        others.forEach((prim) => drawTriangle(prim, 'other'));
        special.forEach(([prim, role]) => drawTriangle(prim, role));
        boxes.forEach((box, i) => {
            if (drawable[i] && i !== chosen && i < boxes.length - 1)
                drawBox(box, colours.way, 1);
        });
        if (boxes.length && drawable[boxes.length - 1])
            drawBox(boxes[boxes.length - 1], colours.away, 2.5);
        if (chosen >= 0 && chosen < boxes.length - 1 && drawable[chosen])
            drawBox(boxes[chosen], colours.chosen, 2.5);
        if (rayIsFinite)
            drawRay();
        if (exact)
            dot(exact, colours.exact);
        say(others.length + special.length);
    }

    // --- hands ------------------------------------------------------------------------------------------------------

    function rotate(a, b, angle) {
        const c = Math.cos(angle), s = Math.sin(angle), [u, v] = [turn[a], turn[b]];
        turn = turn.slice();
        turn[a] = u.map((x, k) => c * x + s * v[k]);
        turn[b] = v.map((x, k) => c * x - s * u[k]);
    }

    const keys = {
        ArrowLeft: () => rotate(0, 2, 0.1), ArrowRight: () => rotate(0, 2, -0.1),
        ArrowUp: () => rotate(1, 2, -0.1), ArrowDown: () => rotate(1, 2, 0.1),
        '+': () => { zoom *= 1.25; }, '-': () => { zoom /= 1.25; }, 0: () => start('node'),
        '[': () => { chosen = Math.min(Math.max(0, chosen - 1), boxes.length - 1); },
        ']': () => { chosen = Math.min(boxes.length - 1, chosen + 1); },
    };
    const buttons = { 'look-scene': () => start('scene'), 'look-node': () => start('node'), 'look-hit': () => start('hit'),
                      'step-up': keys['['], 'step-down': keys[']'] };

    canvas.addEventListener('keydown', (event) => {
        if (!keys[event.key])
            return;
        event.preventDefault();
        keys[event.key]();
        draw();
    });
    for (const [id, act] of Object.entries(buttons))
        document.getElementById(id).addEventListener('click', () => { act(); draw(); });
    let from = null;
    canvas.addEventListener('pointerdown', (event) => {
        from = [event.clientX, event.clientY];
        canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointerup', () => { from = null; });
    canvas.addEventListener('pointermove', (event) => {
        if (!from)
            return;
        rotate(0, 2, (from[0] - event.clientX) * 0.008);
        rotate(1, 2, (event.clientY - from[1]) * 0.008);
        from = [event.clientX, event.clientY];
        draw();
    });
    canvas.addEventListener('wheel', (event) => {
        event.preventDefault();
        zoom = Math.min(1e4, Math.max(0.05, zoom * Math.exp(-0.001 * event.deltaY)));
        draw();
    }, { passive: false });

    for (const [role, text] of Object.entries(key)) {
        const line = document.createElement('li'), square = document.createElement('i');
        square.style.background = colours[role];
        line.append(square, text);
        document.getElementById('key').append(line);
    }
    start('node');
    draw();
    return { boxes, expected, answered };
})();
