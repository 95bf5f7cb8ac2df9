// Traces the rays of a page of raydiff web by the visitor's own graphics card, and says whether it shows the finding.
// What it says stands in #gpu: data-state is `shows`, `right` or `none`.

(async () => {
    const NO_PRIM = 0xFFFFFFFF, DONE = 1, ANSWER = 5, HIT = 4, RIGHT = 8;
    const section = document.getElementById('gpu'), says = document.getElementById('gpu-says');
    const rays = wordsOf(pageData.rays), count = rays.length / 8, shown = pageData.shown;
    const rights = wordsOf(pageData.rights), ranges = new Float32Array(rights.buffer);

    const hex = (word) => '0x' + word.toString(16).padStart(8, '0');

    // What is right of each ray: places in the list; none: any answer is.
    const rightOf = Array.from({ length: count }, () => []);
    for (let at = 0; at < rights.length; at += RIGHT)
        rightOf[rights[at]].push(at);

    // `answer` is four words: t, u, v and the triangle.
    function isRight(ray, answer) {
        const as = new Float32Array(answer.slice(0, 3).buffer), prim = answer[3];
        const within = (at) => [0, 1, 2].every((k) => as[k] >= ranges[at + 2 + 2 * k] && as[k] <= ranges[at + 3 + 2 * k]);
        return rightOf[ray].length === 0 ||
            rightOf[ray].some((at) => rights[at + 1] === prim && (prim === NO_PRIM || within(at)));
    }

    function told(answer) {
        if (answer[3] === NO_PRIM)
            return 'a miss';
        const as = new Float32Array(answer.slice(0, 3).buffer);
        return `triangle ${answer[3]} at t = ${as[0]} (${hex(answer[0])}), u = ${as[1]}, v = ${as[2]}`;
    }

    // Compares the answers of a job; writes its line.
    function compare(job, words) {
        const c = job.answers === null ? null : wordsOf(job.answers);
        const answers = Array.from({ length: count }, (_, i) => words.slice(ANSWER * i, ANSWER * i + HIT));
        const done = (i) => words[ANSWER * i + HIT] === DONE;
        const wrong = answers.map((answer, i) => !done(i) || !isRight(i, answer));
        const other = c && answers.filter((answer, i) => answer.some((word, k) => word !== c[HIT * i + k])).length;
        const mine = answers[shown], verdict = wrong[shown] ? 'WRONG' : rightOf[shown].length ? 'right' : 'out of contract';
        const sums = { wrong: wrong.filter((is) => is).length, other: other ?? '' };
        line(job, { verdict, flag: words[ANSWER * shown + HIT], t: hex(mine[0]), u: hex(mine[1]), v: hex(mine[2]),
                    prim: mine[3] === NO_PRIM ? 'none' : mine[3], rays: count, ...sums, words: [...words].map(hex).join(' ') },
             [done(shown) ? told(mine) : 'not finished', verdict, c ? told(c.slice(HIT * shown, HIT * shown + HIT)) : '-', count,
              sums.wrong, c ? other : '-']);
        return { wrong: wrong[shown], mine };
    }

    // A WRONG answer that is explained may be one that WGSL's wider bounds allow.
    function isExplained(answer) {
        const e = pageData.explained, prim = e.answer.prim ?? NO_PRIM;
        const words = ['t', 'u', 'v'].map((name) => Number(e.answer[name].bits));
        return e.finished && e.judgement.verdict === 'wrong' && prim === answer[3] &&
            (prim === NO_PRIM || words.every((word, k) => word === answer[k]));
    }

    function line(job, numbers, cells) {
        const row = document.createElement('tr');
        Object.assign(row.dataset, { layout: job.layout }, numbers);
        for (const text of [job.layout, ...cells]) {
            const cell = document.createElement('td');
            cell.textContent = text;
            row.append(cell);
        }
        section.querySelector('tbody').append(row);
    }

    function say(state, text, more) {
        says.textContent = text;
        says.className = state === 'shows' ? 'bad' : '';
        Object.assign(section.dataset, more, { state });
    }

    async function open() {
        if (!navigator.gpu)
            throw new Refusal('this browser has no WebGPU' + (window.isSecureContext ? '' : ' on pages that are not secure'));
        const adapter = await navigator.gpu.requestAdapter();
        if (!adapter)
            throw new Refusal('the browser has WebGPU, but no graphics card for it');
        const device = await adapter.requestDevice({ requiredLimits: wantedLimits(adapter) });
        const { vendor, architecture, device: name, description } = adapter.info ?? {};
        section.dataset.adapter = [vendor, architecture, name, description].filter((text) => text).join(' ');
        return runnerOf(device, { GPUBufferUsage, GPUMapMode, GPUShaderStage });
    }

    says.textContent = 'This browser opens the graphics card ...';
    try {
        const runner = await open();
        says.textContent = 'The graphics card traces ...';
        let shows = false, same = false, ran = 0;
        for (const job of pageData.jobs) {
            if (job.words === null) {
                line(job, { verdict: 'none' }, [`not traced: ${job.why}`, '', '', '', '', '']);
                continue;
            }
            await runner.prepare(wordsOf(job.words));
            const bytes = await runner.run(rays, count);
            const { wrong, mine } = compare(job, new Uint32Array(bytes.buffer, bytes.byteOffset, ANSWER * count));
            shows ||= wrong;
            same ||= isExplained(mine);
            ran++;
        }
        const card = section.dataset.adapter || 'it does not say what it is';
        if (!ran)
            say('none', 'Nothing was traced: no layout here has WGSL.');
        else if (shows)
            say('shows', `Your graphics card (${card}) answers WRONG: it shows the finding.`);
        else if (same)
            say('right', `Your graphics card (${card}) gives the WRONG answer that is explained here, which the bounds of ` +
                'WGSL allow: it does not show the finding.');
        else
            say('right', `Your graphics card (${card}) does not show ${pageData.finding ? 'the finding' : 'a wrong answer'}.`);
    } catch (error) {
        const reason = error instanceof Error ? error.message : String(error);
        say('none', `Nothing is traced here: ${reason}.`, { reason });
    }
})();
