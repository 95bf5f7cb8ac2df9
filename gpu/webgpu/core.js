// Runs WGSL on a GPUDevice: what engine webgpu's process (gpu/webgpu/peer.js) and the pages of raydiff web share. It
// knows nothing of rays and trees, and nothing of where it runs.
//
// A program with its data are words, as the engine makes them: a head of 16 (bytes of the text, words of each of the
// three arrays, words of a record that goes in and of one that comes out, 0, 0, the uniform's eight words), the text,
// padded to words, the arrays. It runs on records, one invocation each.

const ARRAYS = 3, HEAD = 16, UNIFORM = 8, GROUP = 64;

class Refusal extends Error {}

// The limits that a device is opened with, so that a large tree fits.
function wantedLimits(adapter) {
    const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
    return { maxStorageBufferBindingSize, maxBufferSize };
}

// `constants` has GPUBufferUsage, GPUMapMode and GPUShaderStage.
function runnerOf(device, constants) {
    const usage = constants.GPUBufferUsage;
    const types = ['uniform', 'read-only-storage', 'storage', ...Array(ARRAYS).fill('read-only-storage')];
    const layout = device.createBindGroupLayout({
        entries: types.map((type, binding) => ({ binding, visibility: constants.GPUShaderStage.COMPUTE,
                                                 buffer: { type } })),
    });
    const pipelines = new Map();
    let job = { buffers: [] };

    // Calls make(), which must leave no error of the device.
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

    async function pipelineOf(text) {
        if (!pipelines.has(text))
            pipelines.set(text, await checked(() => device.createComputePipeline({
                layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
                compute: { module: device.createShaderModule({ code: text }), entryPoint: 'main' },
            })));
        return pipelines.get(text);
    }

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
        await own[3].mapAsync(constants.GPUMapMode.READ);
        const result = new Uint8Array(own[3].getMappedRange().slice(0, 4 * count * job.out));
        own.forEach((buffer) => buffer.destroy());
        return result;
    }

    return { prepare, run, recordWords: () => job.into };
}
