// Opens a page of raydiff web in headless Chromium and prints, as JSON, what stands in it afterwards: what the browser's
// graphics card answered, the view after each of some keys, the console, everything that was asked for. Keeps a
// screenshot of the view and looks whether what should be seen is there, at places that are computed here from the
// numbers of the page, not by its script.
//   node tests/web/browse.js PAGE.html SCREENSHOT.png PROFILE [none]     none: a browser without WebGPU
// It talks to Chromium by a pipe (--remote-debugging-pipe).
'use strict';
const { spawn } = require('child_process');
const fs = require('fs');
const path = require('path');
const zlib = require('zlib');

const [page, shot, profile, without] = process.argv.slice(2);
const flags = ['--headless=new', '--no-sandbox', '--no-first-run', '--disable-background-networking', '--disable-sync',
    '--disable-component-update', '--hide-scrollbars', '--force-device-scale-factor=1', '--remote-debugging-pipe',
    '--window-size=1100,900', '--host-resolver-rules=MAP * ~NOTFOUND', `--user-data-dir=${profile}`,
    ...(without ? ['--disable-gpu', '--disable-features=WebGPU']
        : ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan'])];

// --- the browser ---------------------------------------------------------------------------------------------------

const child = spawn('chromium', [...flags, 'about:blank'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
const waiting = new Map(), heard = [];
let number = 0, rest = Buffer.alloc(0);
child.stdio[4].on('data', (bytes) => {
    rest = Buffer.concat([rest, bytes]);
    for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1)) {
        const message = JSON.parse(rest.subarray(0, end).toString());
        if (message.id)
            waiting.get(message.id)(message);
        else
            heard.push(message);
    }
});

function ask(method, params, session) {
    return new Promise((resolve, reject) => {
        waiting.set(++number, (got) => (got.error ? reject(new Error(`${method}: ${got.error.message}`)) : resolve(got.result)));
        child.stdio[3].write(JSON.stringify({ id: number, method, params, sessionId: session }) + '\0');
    });
}

function end(code) {
    child.kill('SIGKILL');
    process.exit(code);
}
child.on('exit', () => { console.error('chromium ended'); process.exit(4); });
setTimeout(() => { console.error('no end within 90 s'); end(4); }, 90000);

// --- pictures ------------------------------------------------------------------------------------------------------

// The pixels of a PNG of eight bits a channel.
function pixelsOf(png) {
    let at = 8, width, height, channels;
    const parts = [];
    while (at < png.length) {
        const size = png.readUInt32BE(at), kind = png.toString('latin1', at + 4, at + 8), body = png.subarray(at + 8, at + 8 + size);
        if (kind === 'IHDR')
            [width, height, channels] = [body.readUInt32BE(0), body.readUInt32BE(4), { 2: 3, 6: 4 }[body[9]]];
        if (kind === 'IDAT')
            parts.push(body);
        at += 12 + size;
    }
    const raw = zlib.inflateSync(Buffer.concat(parts)), stride = width * channels, out = Buffer.alloc(stride * height);
    for (let y = 0; y < height; y++)
        for (let x = 0; x < stride; x++) {
            const a = x >= channels ? out[y * stride + x - channels] : 0, b = y ? out[(y - 1) * stride + x] : 0;
            const c = y && x >= channels ? out[(y - 1) * stride + x - channels] : 0, p = a + b - c;
            const paeth = Math.abs(p - a) <= Math.abs(p - b) && Math.abs(p - a) <= Math.abs(p - c) ? a
                : Math.abs(p - b) <= Math.abs(p - c) ? b : c;
            const add = [0, a, b, (a + b) >> 1, paeth][raw[y * (stride + 1)]];
            out[y * stride + x] = raw[y * (stride + 1) + 1 + x] + add;
        }
    return { width, height, at: (x, y) => [...out.subarray(y * stride + x * channels, y * stride + x * channels + 3)] };
}

const near = (a, b) => a.every((value, k) => Math.abs(value - b[k]) <= 40);
const parse = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));

// How many pixels within `reach` of a place have the colour.
function count(picture, place, reach, colour) {
    let found = 0;
    for (let y = Math.round(place[1]) - reach; y <= place[1] + reach; y++)
        for (let x = Math.round(place[0]) - reach; x <= place[0] + reach; x++)
            if (x >= 0 && y >= 0 && x < picture.width && y < picture.height && near(picture.at(x, y), colour))
                found++;
    return found;
}

// Where the view should have drawn a point of the scene.
function placer(view, size) {
    const numbers = (text) => text.split(' ').map(Number);
    const focus = numbers(view.focus), turn = numbers(view.turn), scale = 0.4 * size[1] / Number(view.radius) * Number(view.zoom);
    return (p) => [0, 1].map((axis) => {
        const far = [0, 1, 2].reduce((sum, k) => sum + turn[3 * axis + k] * (p[k] - focus[k]), 0);
        return axis ? size[1] / 2 - scale * far : size[0] / 2 + scale * far;
    });
}

const floatAt = (bits) => { const b = Buffer.alloc(4); b.writeUInt32BE(Number(bits)); return b.readFloatBE(0); };

// What is to be seen: pixels of the hit, of each corner of the node's box, of the ray's end at the origin.
function look(picture, view, data) {
    const place = placer(view, [760, 520]), e = data.explained, seen = {};
    const inside = (p) => p[0] > 3 && p[1] > 3 && p[0] < 757 && p[1] < 517;
    if (e.truth.prim !== null) {
        const t = (e.truth.t_lo + e.truth.t_hi) / 2;
        seen.exact = count(picture, place(e.origin.map((o, k) => floatAt(o.bits) + t * floatAt(e.direction[k].bits))), 3, parse('#16803c'));
    }
    if (e.way.length) {
        const step = e.way[e.last];
        const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => place([0, 1, 2].map((k) => floatAt((i >> k & 1 ? step.hi : step.lo)[k].decoded.bits))));
        // What the dot of the hit or a line of the ray covers is left out.
        const shown = corners.filter((p) => inside(p) && count(picture, p, 9, parse('#16803c')) + count(picture, p, 3, parse('#0b3d91')) === 0);
        seen.corners = shown.length;
        seen.away = shown.filter((p) => count(picture, p, 3, parse('#c4262e')) > 2).length;
    }
    return seen;
}

// --- all -----------------------------------------------------------------------------------------------------------

(async () => {
    const { targetInfos } = await ask('Target.getTargets');
    const target = targetInfos.find((info) => info.type === 'page').targetId;
    const { sessionId } = await ask('Target.attachToTarget', { targetId: target, flatten: true });
    const tell = (method, params) => ask(method, params, sessionId);
    for (const domain of ['Page', 'Runtime', 'Network', 'Log'])
        await tell(`${domain}.enable`);
    await tell('Page.navigate', { url: 'file://' + path.resolve(page) });
    const value = async (expression) => JSON.parse((await tell('Runtime.evaluate', { expression: `JSON.stringify(${expression})` })).result.value ?? 'null');
    const of = (id) => value(`{...document.getElementById('${id}')?.dataset}`);
    let gpu = {};
    for (let i = 0; i < 300 && (!gpu.state || gpu.state === 'waiting'); i++) {
        await new Promise((resolve) => setTimeout(resolve, 200));
        gpu = await of('gpu');
    }
    const out = { gpu, says: await value("document.getElementById('gpu-says').textContent"),
                  jobs: await value("[...document.querySelectorAll('#gpu tbody tr')].map((row) => ({...row.dataset, text: row.textContent}))"),
                  view: await of('view'), shown: await value("document.getElementById('shown').textContent"), keys: {} };
    const data = await value("JSON.parse(document.getElementById('data').textContent)");
    await value("(document.getElementById('view').scrollIntoView({ block: 'start' }), 0)");
    const box = await value("(({ x, y }) => ({ x, y }))(document.getElementById('view').getBoundingClientRect())");
    const scroll = await value('window.scrollY');
    // The border is one pixel wide.
    const { data: png } = await tell('Page.captureScreenshot', { format: 'png', captureBeyondViewport: true,
        clip: { x: box.x + 1, y: box.y + 1 + scroll, width: 760, height: 520, scale: 1 } });
    fs.writeFileSync(shot, Buffer.from(png, 'base64'));
    out.seen = look(pixelsOf(Buffer.from(png, 'base64')), out.view, data);
    await value("(document.getElementById('view').focus(), 0)");
    for (const key of ['[', 'ArrowLeft', '+', '0']) {
        await tell('Input.dispatchKeyEvent', { type: 'keyDown', key, text: key.length === 1 ? key : undefined });
        await tell('Input.dispatchKeyEvent', { type: 'keyUp', key });
        out.keys[key] = await of('view');
    }
    out.console = heard.filter((m) => m.method === 'Runtime.consoleAPICalled' || m.method === 'Runtime.exceptionThrown' ||
        m.method === 'Log.entryAdded').map((m) => JSON.stringify(m.params).slice(0, 300));
    out.requests = heard.filter((m) => m.method === 'Network.requestWillBeSent').map((m) => m.params.request.url);
    console.log(JSON.stringify(out, null, 1));
    child.removeAllListeners('exit').on('exit', () => process.exit(0));
    await ask('Browser.close'); // so that nothing is written to the profile any more
})().catch((error) => { console.error(error.message); end(4); });
