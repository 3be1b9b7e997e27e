// extract.mjs - what a peer's ambient occlusion pass draws, as plain data: its GLSL, uniforms, textures, draw by draw.
//
// The packages' own classes decide all of that. They are made here, in node, with a camera of ours, and render() is
// called with a renderer that draws nothing and notes what it is told. None of their text is in this repository: it
// goes from the installed package into the cache folder.
//
//   node extract.mjs CACHE                    install the packages into CACHE, unless they are there
//   node extract.mjs CACHE REQUEST.json OUT   and write OUT/NAME.json, a recipe, for each variant of the request
//
// request  { width, height, near, far, projection: 16 numbers, column-major, OpenGL clip,
//            variants: [ { name, peer: "three" | "n8ao", settings: { ... } } ] }, settings by the names of the package
// recipe   { peer, version, taps, textures, passes, result }: see recipe() below; peers.c draws it
//
// exit: 0 done; 2 usage or request; 3 the packages cannot be installed; 4 a package is not built as we expect
import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const pinned = { three: '0.187.0', n8ao: '2.1.0', postprocessing: '6.39.6' }; // the last one is imported by n8ao

function fail(code, text) {
    console.error('extract: ' + text);
    process.exit(code);
}

// ----------------------------------------------------------------------------------------------------------- packages

function installed(cache) {
    return Object.entries(pinned).every(([name, version]) => {
        const file = join(cache, 'node_modules', name, 'package.json');
        return existsSync(file) && JSON.parse(readFileSync(file, 'utf8')).version === version;
    });
}

function install(cache) {
    const wanted = Object.entries(pinned).map(([name, version]) => name + '@' + version);
    const empty = join(cache, 'package.json');
    mkdirSync(cache, { recursive: true });
    if (!existsSync(empty)) writeFileSync(empty, '{ "private": true }\n');
    console.error('extract: npm install ' + wanted.join(' '));
    const options = ['install', '--prefix', cache, '--save-exact', '--ignore-scripts', '--no-audit', '--no-fund'];
    const npm = spawnSync('npm', [...options, ...wanted],
                          { stdio: ['ignore', 'ignore', 'pipe'], encoding: 'utf8', timeout: 120000 });
    if (npm.status !== 0 || !installed(cache))
        fail(3, `${npm.error ?? npm.stderr}\nextract: npm cannot install ${wanted.join(', ')}: it needs the registry`);
}

const load = (cache, file) => import(pathToFileURL(join(cache, 'node_modules', file)).href);

// ------------------------------------------------------------------------------------------------------------ shaders

// What three.js puts before a shader, as far as these passes use it: version, defines, the names of GLSL 1. The
// full-screen triangle needs no transform.
function prefix(THREE, material, vertex) {
    const defines = Object.entries(material.defines ?? {}).filter(([, value]) => value !== false);
    const vertexLines = ['#define varying out', 'in vec3 position;', 'in vec2 uv;',
                         'const mat4 projectionMatrix = mat4(1.0);', 'const mat4 modelViewMatrix = mat4(1.0);'];
    const fragmentLines = ['#define varying in', '#define texture2D texture', '#define gl_FragColor fragment_color',
                           'layout(location = 0) out highp vec4 fragment_color;',
                           THREE.ShaderChunk.colorspace_pars_fragment];
    return ['#version 300 es', 'precision highp float;', 'precision highp int;', 'precision highp sampler2D;',
            ...defines.map(([name, value]) => `#define ${name} ${value}`),
            ...(vertex ? vertexLines : fragmentLines)].join('\n') + '\n';
}

function includes(THREE, text) {
    return text.replace(/^[ \t]*#include +<([\w./]+)>/gm, (line, name) => {
        if (THREE.ShaderChunk[name] === undefined) fail(4, 'three.js has no shader chunk ' + name);
        return includes(THREE, THREE.ShaderChunk[name]);
    });
}

function replace(path, content) {
    const temporary = `${path}.${process.pid}`;
    writeFileSync(temporary, content);
    renameSync(temporary, path);
}

// Writes a file once, named after its content.
function keep(folder, kind, content) {
    const name = createHash('sha256').update(content).digest('hex').slice(0, 16) + '.' + kind;
    if (!existsSync(join(folder, name))) replace(join(folder, name), content);
    return name;
}

// ----------------------------------------------------------------------------------------------------------- renderer

function formatOf(THREE, texture) {
    const red = texture.format === THREE.RedFormat;
    const table = new Map([[THREE.UnsignedByteType, red ? null : 'rgba8'], [THREE.FloatType, red ? 'r32f' : 'rgba32f'],
                           [THREE.HalfFloatType, red ? null : 'rgba16f']]);
    return table.get(texture.type) ?? fail(4, `a texture of type ${texture.type}, format ${texture.format}`);
}

// Flat, booleans as 0 and 1, infinity as a large number, which JSON has; null: neither number nor list nor vector.
function numbers(value) {
    if (['number', 'boolean'].includes(typeof value)) return [Math.min(Math.max(Number(value), -3e38), 3e38)];
    if (Array.isArray(value)) return value.flatMap(numbers);
    if (typeof value?.toArray === 'function') return value.toArray();
    return null;
}

// Draws nothing, notes everything. inputs: [texture, kind] of those that the host fills.
class Recorder {
    constructor(THREE, folder, inputs) {
        Object.assign(this, { THREE, folder, inputs, textures: [], known: new Map(), passes: [], target: null });
        Object.assign(this, { clearColor: [0, 0, 0, 0], cleared: false, autoClear: true, xr: { enabled: false } });
        Object.assign(this, { capabilities: {}, extensions: { has: () => true } }); // n8ao asks for float targets
    }
    getClearColor(color) { return color.setRGB(...this.clearColor.slice(0, 3)); }
    getClearAlpha() { return this.clearColor[3]; }
    setClearColor(color) { this.clearColor = [...new this.THREE.Color(color).toArray(), this.clearColor[3]]; }
    setClearAlpha(alpha) { this.clearColor[3] = alpha; }
    setRenderTarget(target) { this.target = target; this.cleared = false; }
    clear() { this.cleared = true; }

    texture(texture) {
        const { THREE } = this;
        if (this.known.has(texture)) return this.known.get(texture);
        const input = this.inputs.find(([t]) => t === texture);
        const { width, height } = texture.image ?? {};
        const entry = { linear: texture.magFilter === THREE.LinearFilter,
                        repeat: texture.wrapS === THREE.RepeatWrapping };
        Object.assign(entry, input ? { input: input[1] } : { width, height, format: formatOf(THREE, texture) });
        if (texture.isDataTexture) {
            const { data } = texture.image;
            entry.data = keep(this.folder, 'bin', Buffer.from(data.buffer, data.byteOffset, data.byteLength));
        }
        this.known.set(texture, this.textures.push(entry) - 1);
        return this.textures.length - 1;
    }

    render(mesh) {
        const { material } = mesh, { THREE } = this;
        if (!this.target) return; // the screen: composition, which is not ours to compare
        const text = { vertex: prefix(THREE, material, true) + includes(THREE, material.vertexShader),
                       fragment: prefix(THREE, material, false) + includes(THREE, material.fragmentShader) };
        if (/#pragma unroll_loop/.test(text.fragment)) fail(4, 'a shader with loops to unroll');
        const uniforms = [];
        for (const [name, { value }] of Object.entries(material.uniforms)) {
            if (value === null || value === undefined) continue;
            if (value.isTexture) uniforms.push({ name, texture: this.texture(value) });
            else if (numbers(value)) uniforms.push({ name, values: numbers(value) });
        }
        this.passes.push({ vertex: keep(this.folder, 'vert', text.vertex),
                           fragment: keep(this.folder, 'frag', text.fragment),
                           target: this.texture(this.target.texture),
                           clear: this.cleared || this.autoClear ? this.clearColor : null, timed: true, uniforms });
        this.cleared = false;
    }
}

// -------------------------------------------------------------------------------------------------------------- peers

function makeCamera(THREE, request) {
    const camera = new THREE.PerspectiveCamera(50, request.width / request.height, request.near, request.far);
    camera.projectionMatrix.fromArray(request.projection);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    return camera;
}

// three.js: GTAOPass on a depth and a normal texture of the host, as setGBuffer takes them. Its noise gets a seed.
function three(modules, request, settings, folder) {
    const { THREE, GTAOPass } = modules, random = Math.random;
    const depth = new THREE.DepthTexture(request.width, request.height), normal = new THREE.Texture();
    normal.magFilter = THREE.NearestFilter; // as of the normals that the pass renders itself
    let seed = 1;
    Math.random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
    const pass = new GTAOPass(new THREE.Scene(), makeCamera(THREE, request), request.width, request.height,
                              { depthTexture: depth, normalTexture: normal });
    Math.random = random;
    pass.setSize(request.width, request.height);
    pass.updateGtaoMaterial(settings);
    pass.output = GTAOPass.OUTPUT.Off;
    const recorder = new Recorder(THREE, folder, [[depth, 'depth'], [normal, 'normal']]);
    pass.render(recorder, null, null);
    const { SAMPLES } = pass.gtaoMaterial.defines, lines = SAMPLES < 30 ? 3 : 5; // as in shaders/GTAOShader.js
    return { recorder, result: recorder.texture(pass.gtaoMap), taps: 2 * lines * Math.ceil(SAMPLES / lines) };
}

// n8ao: reads depth only. Its last pass, composition, is drawn in mode "AO", black on white without sRGB: the ao that
// it multiplies with. It is not timed, since other methods are without composition, too.
function n8ao(modules, request, settings, folder) {
    const { THREE, N8AOPass } = modules;
    const pass = new N8AOPass(new THREE.Scene(), makeCamera(THREE, request), request.width, request.height);
    const screen = new THREE.WebGLRenderTarget(request.width, request.height, { type: THREE.FloatType });
    pass.setSize(request.width, request.height);
    Object.assign(pass.configuration, { autoRenderBeauty: false, gammaCorrection: false }, settings);
    pass.setDisplayMode('AO');
    pass.renderToScreen = false;
    const { depthTexture, texture } = pass.beautyRenderTarget;
    const recorder = new Recorder(THREE, folder, [[depthTexture, 'depth'], [texture, 'white']]);
    pass.render(recorder, screen, null);
    recorder.passes.at(-1).timed = false;
    return { recorder, result: recorder.texture(screen.texture), taps: pass.configuration.aoSamples };
}

function recipe(modules, request, variant, folder) {
    const peers = { three, n8ao };
    if (!peers[variant.peer]) fail(2, `${variant.name}: there is no peer ${variant.peer}`);
    const { recorder, result, taps } = peers[variant.peer](modules, request, variant.settings ?? {}, folder);
    const { textures, passes } = recorder;
    return { peer: variant.peer, version: pinned[variant.peer], taps, textures, passes, result };
}

// --------------------------------------------------------------------------------------------------------------- main

const [, , cacheArgument, requestFile, out, ...rest] = process.argv;
if (!cacheArgument || cacheArgument.startsWith('-') || rest.length || (requestFile && !out))
    fail(2, 'usage: node extract.mjs CACHE [REQUEST.json OUT]');
const cache = resolve(cacheArgument);
if (!installed(cache)) install(cache);
if (requestFile) {
    const request = JSON.parse(readFileSync(requestFile, 'utf8'));
    let modules;
    try {
        modules = { THREE: await load(cache, 'three/build/three.module.js'),
                    ...await load(cache, 'three/examples/jsm/postprocessing/GTAOPass.js'),
                    ...await load(cache, 'n8ao/dist/N8AO.js') };
    } catch (error) {
        fail(4, 'the packages do not load: ' + error.message);
    }
    mkdirSync(out, { recursive: true });
    for (const variant of request.variants)
        replace(join(out, variant.name + '.json'), JSON.stringify(recipe(modules, request, variant, out)));
}
