// Runs WGSL by Dawn for engine webgpu: node --input-type=module -e TEXT -- MODULE SOFT OPTION...
//
// TEXT is gpu/webgpu/core.js and this file. It speaks the pipe's binary form (ref/outside/pipe.h), in version 3: a request
// brings a program and its data, and records on which the program runs.
//
//   request  "RDRQ", 3, query, words, 0, records, same, 0
//            then, unless `same` is 1, so many words, as core.js has them; then the records
//   answer   "RDRA", 3, refused, count, formula 0, rounding 2 (Vulkan's: WGSL's), 0, 0
//            then the records, or `count` bytes of text
import { readSync, writeSync } from 'node:fs';

const [modulePath, soft, ...options] = process.argv.slice(1);

function read(bytes, eofAllowed) {
    const buffer = new Uint8Array(bytes);
    for (let at = 0; at < bytes;) {
        const got = readSync(0, buffer, at, bytes - at);
        if (got === 0 && at === 0 && eofAllowed)
            process.exit(0);
        if (got === 0)
            throw new Error('a request ends before its end');
        at += got;
    }
    return buffer;
}

function readWords(count, eofAllowed) {
    const bytes = read(4 * count, eofAllowed);
    return new Uint32Array(bytes.buffer);
}

function write(bytes) {
    for (let at = 0; at < bytes.length;)
        at += writeSync(1, bytes, at);
}

const MAGIC = new Uint32Array(Uint8Array.from('RDRQRDRA', (c) => c.charCodeAt(0)).buffer);

function answer(version, refused, count, body) {
    write(new Uint8Array(Uint32Array.of(MAGIC[1], version, refused, count, 0, 2, 0, 0).buffer));
    write(body);
}

function refuse(version, text) {
    const bytes = new TextEncoder().encode(text.replace(/\s+/g, ' ')).subarray(0, 256);
    answer(version, 1, bytes.length, bytes);
}

// --- the device ----------------------------------------------------------------------------------------------------

let gpu, runner;

async function open() {
    process.env.XDG_RUNTIME_DIR ??= '/'; // else a library of the driver writes a line that means nothing here
    const { create, globals } = await import(modulePath);
    gpu = create(['backend=vulkan', ...options]); // it must outlive what it makes
    const adapter = await gpu.requestAdapter();
    if (!adapter)
        throw new Refusal('Dawn takes no Vulkan device here');
    const { isFallbackAdapter, architecture } = adapter.info;
    if (soft === 'hardware' && (isFallbackAdapter || /swiftshader|software/.test(architecture)))
        throw new Refusal('Dawn has no graphics card here');
    const device = await adapter.requestDevice({ requiredLimits: wantedLimits(adapter) });
    device.lost.then((info) => {
        process.stderr.write(`the device is lost: ${info.message}\n`);
        process.exit(3);
    });
    runner = runnerOf(device, globals);
}

// --- requests ------------------------------------------------------------------------------------------------------

async function serve(head) {
    const [magic, version, , words, , records, same] = head;
    if (magic !== MAGIC[0] || (version !== 1 && version !== 3))
        throw new Error('a request of another form');
    try {
        if (version === 1) {
            await open();
            return answer(1, 0, 0, new Uint8Array(0));
        }
        if (!same)
            await runner.prepare(readWords(words));
        const body = records ? await runner.run(readWords(records * runner.recordWords()), records) : new Uint8Array(0);
        return answer(3, 0, records, body);
    } catch (error) {
        if (!(error instanceof Refusal))
            throw error;
        return refuse(version, error.message);
    }
}

for (;;)
    await serve(readWords(8, true));
