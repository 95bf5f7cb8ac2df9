// Runs WGSL by Dawn for engine webgpu: node --input-type=module -e TEXT -- MODULE SOFT OPTION...
//
// It speaks the pipe's binary form (ref/outside/pipe.h), in version 3: a request brings a program and its data, and
// records on which the program runs, one invocation each. It knows nothing of rays and trees.
//
//   request  "RDRQ", 3, query, words, 0, records, same, 0
//            then, unless `same` is 1, so many words: head (16 words: bytes of the text, words of each of the three
//            arrays, words of a record that goes in and of one that comes out, 0, 0, the uniform's eight words), the
//            text, padded to words, the arrays; then the records
//   answer   "RDRA", 3, refused, count, formula 0, rounding 2 (Vulkan's: WGSL's), 0, 0
//            then the records, or `count` bytes of text
import { readSync, writeSync } from 'node:fs';

const [modulePath, soft, ...options] = process.argv.slice(1);
const ARRAYS = 3, HEAD = 16, UNIFORM = 8, GROUP = 64;

class Refusal extends Error {}

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

let gpu, device, usage, mapMode, layout;

async function open() {
    process.env.XDG_RUNTIME_DIR ??= '/'; // else a library of the driver writes a line that means nothing here
    const { create, globals } = await import(modulePath);
    usage = globals.GPUBufferUsage;
    mapMode = globals.GPUMapMode;
    gpu = create(['backend=vulkan', ...options]); // it must outlive what it makes
    const adapter = await gpu.requestAdapter();
    if (!adapter)
        throw new Refusal('Dawn takes no Vulkan device here');
    const { isFallbackAdapter, architecture } = adapter.info;
    if (soft === 'hardware' && (isFallbackAdapter || /swiftshader|software/.test(architecture)))
        throw new Refusal('Dawn has no graphics card here');
    const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
    device = await adapter.requestDevice({ requiredLimits: { maxStorageBufferBindingSize, maxBufferSize } });
    device.lost.then((info) => {
        process.stderr.write(`the device is lost: ${info.message}\n`);
        process.exit(3);
    });
    const types = ['uniform', 'read-only-storage', 'storage', ...Array(ARRAYS).fill('read-only-storage')];
    layout = device.createBindGroupLayout({
        entries: types.map((type, binding) => ({ binding, visibility: globals.GPUShaderStage.COMPUTE,
                                                 buffer: { type } })),
    });
}

// Calls make(), which must leave no error of Dawn.
async function checked(make) {
    for (const kind of ['validation', 'out-of-memory', 'internal'])
        device.pushErrorScope(kind);
    const made = make();
    for (let i = 0; i < 3; i++) {
        const error = await device.popErrorScope();
        if (error)
            throw new Refusal(error.message);
    }
    return made;
}

function bufferOf(words, more) {
    const buffer = device.createBuffer({ size: Math.max(16, 16 * Math.ceil(words / 4)), usage: more });
    return buffer;
}

function filled(words, more) {
    const buffer = bufferOf(words.length, more | usage.COPY_DST);
    device.queue.writeBuffer(buffer, 0, words);
    return buffer;
}

// --- a program and its data ----------------------------------------------------------------------------------------

const pipelines = new Map();

async function pipelineOf(text) {
    if (!pipelines.has(text))
        pipelines.set(text, await checked(() => device.createComputePipeline({
            layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
            compute: { module: device.createShaderModule({ code: text }), entryPoint: 'main' },
        })));
    return pipelines.get(text);
}

let job = { buffers: [] };

async function prepare(words) {
    job.buffers.forEach((buffer) => buffer.destroy());
    job = { buffers: [] };
    const textWords = Math.ceil(words[0] / 4);
    const bytes = new Uint8Array(words.buffer, words.byteOffset + 4 * HEAD, words[0]);
    const next = { buffers: [], into: words[4], out: words[5], uniform: words.slice(8, 8 + UNIFORM) };
    next.pipeline = await pipelineOf(new TextDecoder().decode(bytes));
    let at = HEAD + textWords;
    await checked(() => {
        for (let i = 0; i < ARRAYS; i++) {
            next.buffers.push(filled(words.subarray(at, at + words[1 + i]), usage.STORAGE));
            at += words[1 + i];
        }
    });
    job = next;
}

async function run(records, count) {
    const uniform = Uint32Array.from(job.uniform);
    uniform[0] = count;
    const own = await checked(() => [
        filled(uniform, usage.UNIFORM),
        filled(records, usage.STORAGE),
        bufferOf(count * job.out, usage.STORAGE | usage.COPY_SRC),
        bufferOf(count * job.out, usage.MAP_READ | usage.COPY_DST),
    ]);
    await checked(() => {
        const bound = [...own.slice(0, 3), ...job.buffers];
        const encoder = device.createCommandEncoder(), pass = encoder.beginComputePass();
        pass.setPipeline(job.pipeline);
        pass.setBindGroup(0, device.createBindGroup({
            layout,
            entries: bound.map((buffer, binding) => ({ binding, resource: { buffer } })),
        }));
        pass.dispatchWorkgroups(Math.ceil(count / GROUP));
        pass.end();
        encoder.copyBufferToBuffer(own[2], 0, own[3], 0, own[3].size);
        device.queue.submit([encoder.finish()]);
    });
    await own[3].mapAsync(mapMode.READ);
    const result = new Uint8Array(own[3].getMappedRange().slice(0, 4 * count * job.out));
    own.forEach((buffer) => buffer.destroy());
    return result;
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
            await prepare(readWords(words));
        const body = records ? await run(readWords(records * job.into), records) : new Uint8Array(0);
        return answer(3, 0, records, body);
    } catch (error) {
        if (!(error instanceof Refusal))
            throw error;
        return refuse(version, error.message);
    }
}

for (;;)
    await serve(readWords(8, true));
