/* cost.c - see cost.h. A reader of SPIR-V that knows what it needs: definitions, blocks, loops, liveness. Words are
 * read through word(), which never leaves an instruction, so broken modules end in an error. */
#include "cost.h"

#define SPV_ENABLE_UTILITY_CODE
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* inline in spirv.h, and so without a home: this is it */
void SpvHasResultAndType(SpvOp opcode, bool *has_result, bool *has_type);

#define WORDS_MAX  (1 << 18) /* SPIR-V words of a pass after inlining */
#define BOUND_MAX  (1u << 20)
#define BLOCKS_MAX 4096
#define VALUES_MAX 65536
#define TRIPS_MAX  4096  /* longer loops are of unknown length; the longest has 1024 steps */
#define METRICS    ((int)(sizeof(cost_counts) / sizeof(double)))
#define NONE       (-1)

/* ----------------------------------------------------------------------------------------------------------- module */

typedef struct function {
    uint32_t    id;
    int         state; /* 0, 1: being counted, 2: done */
    int         registers;
    cost_counts counts;
} function;

typedef struct module {
    const hbil_plan *plan;
    const hbil_pass *pass;
    const uint32_t  *words;
    uint32_t  count, bound, entry, glsl; /* glsl: id of the import of GLSL.std.450 */
    uint32_t *def;          /* by id: where it is defined, 0: nowhere */
    int32_t  *binding, *set, *block; /* by id: decorations; index of a label in its function */
    function *functions;
    uint32_t  function_count;
    cost     *out;
} module;

static void add(cost_counts *to, const cost_counts *c, double factor)
{
    double *t = (double *)to;
    const double *from = (const double *)c;
    int k;
    for (k = 0; k < METRICS; ++k) t[k] += factor * from[k];
}

static void raise_to(cost_counts *to, const cost_counts *c)
{
    double *t = (double *)to;
    const double *from = (const double *)c;
    int k;
    for (k = 0; k < METRICS; ++k)
        if (from[k] > t[k]) t[k] = from[k];
}

static int fail(module *m, const char *why)
{
    if (!m->out->error) m->out->error = why;
    return 0;
}

static uint32_t length(const module *m, uint32_t at) { return m->words[at] >> 16; }
static uint32_t opcode(const module *m, uint32_t at) { return at ? m->words[at] & 0xffff : SpvOpNop; }
static uint32_t def(const module *m, uint32_t id) { return id < m->bound ? m->def[id] : 0; }
/* Word k of an instruction; 0 behind its end, and of what is not defined. */
static uint32_t word(const module *m, uint32_t at, uint32_t k)
{
    return at && k < length(m, at) ? m->words[at + k] : 0;
}

/* Which word is the id of the result: 2 with a type, 1 without, 0 there is none. */
static uint32_t result_at(uint32_t op)
{
    bool result, type;
    SpvHasResultAndType((SpvOp)op, &result, &type);
    return result ? (type ? 2u : 1u) : 0u;
}

static void decorate(module *m, uint32_t at)
{
    const uint32_t id = word(m, at, 1), kind = word(m, at, 2);
    if (id >= m->bound || length(m, at) < 4) return;
    if (kind == SpvDecorationBinding) m->binding[id] = (int32_t)(word(m, at, 3) & 0xffff);
    if (kind == SpvDecorationDescriptorSet) m->set[id] = (int32_t)(word(m, at, 3) & 0xffff);
}

static int define(module *m, uint32_t at)
{
    const uint32_t op = opcode(m, at), k = result_at(op), id = word(m, at, k);
    if (!k) return 1;
    if (id == 0 || id >= m->bound || m->def[id]) return fail(m, "an id that is out of bounds, or defined twice");
    m->def[id] = at;
    if (op == SpvOpExtInstImport && length(m, at) == 6 && memcmp(m->words + at + 2, "GLSL.std.450", 13) == 0)
        m->glsl = id;
    if (op == SpvOpFunction) m->functions[m->function_count++].id = id;
    return 1;
}

static int read_module(module *m)
{
    uint32_t at, functions = 0;
    for (at = 5; at < m->count; at += length(m, at)) {
        if (length(m, at) == 0 || length(m, at) > m->count - at) return fail(m, "an instruction runs over the end");
        functions += opcode(m, at) == SpvOpFunction;
    }
    m->def = (uint32_t *)calloc(m->bound, sizeof *m->def);
    m->binding = (int32_t *)malloc(3 * m->bound * sizeof *m->binding);
    m->functions = (function *)calloc(functions + 1, sizeof *m->functions);
    if (!m->def || !m->binding || !m->functions) return fail(m, "out of memory");
    memset(m->binding, 0xff, 3 * m->bound * sizeof *m->binding);
    m->set = m->binding + m->bound;
    m->block = m->set + m->bound;
    for (at = 5; at < m->count; at += length(m, at)) {
        if (!define(m, at)) return 0;
        if (opcode(m, at) == SpvOpDecorate) decorate(m, at);
        if (opcode(m, at) == SpvOpEntryPoint && !m->entry) m->entry = word(m, at, 2);
    }
    return m->entry ? 1 : fail(m, "no entry point");
}

/* 32-bit scalars of a type; 0 for pointers, images and void. */
static int components(const module *m, uint32_t type, int depth)
{
    const uint32_t at = def(m, type);
    uint32_t k;
    double n = 0;
    if (depth > 8) return 0;
    switch (opcode(m, at)) {
    case SpvOpTypeBool: return 1;
    case SpvOpTypeInt:
    case SpvOpTypeFloat: return word(m, at, 2) > 32 ? 2 : 1;
    case SpvOpTypeVector:
    case SpvOpTypeMatrix: n = (double)word(m, at, 3) * components(m, word(m, at, 2), depth + 1); break;
    case SpvOpTypeArray:
        n = (double)word(m, def(m, word(m, at, 3)), 3) * components(m, word(m, at, 2), depth + 1);
        break;
    case SpvOpTypeStruct:
        for (k = 2; k < length(m, at) && k < 64; ++k) n += components(m, word(m, at, k), depth + 1);
        break;
    default: return 0;
    }
    return n < 65536 ? (int)n : 65536;
}

static int components_of(const module *m, uint32_t id)
{
    const uint32_t at = def(m, id);
    return result_at(opcode(m, at)) == 2 ? components(m, word(m, at, 1), 0) : 0;
}

/* The variable behind a pointer, an image or what was loaded from it; 0 if that is not known. */
static uint32_t variable(const module *m, uint32_t id)
{
    int depth;
    for (depth = 0; depth < 16; ++depth) {
        const uint32_t at = def(m, id);
        switch (opcode(m, at)) {
        case SpvOpVariable: return at;
        case SpvOpLoad:
        case SpvOpImage:
        case SpvOpSampledImage:
        case SpvOpCopyObject:
        case SpvOpAccessChain:
        case SpvOpInBoundsAccessChain:
        case SpvOpImageTexelPointer: id = word(m, at, 3); break;
        default: return 0;
        }
    }
    return 0;
}

/* -------------------------------------------------------------------------------------------------- one instruction */

/* Index of the plan's texture; NONE: the hook's own. GL's units of textures and of images have the same numbers. */
static int texture_of(const module *m, uint32_t image, int access)
{
    const uint32_t id = word(m, variable(m, image), 2);
    const hbil_access kind = access == COST_FETCH ? HBIL_ACCESS_SAMPLE : HBIL_ACCESS_WRITE;
    int b;
    if (id == 0 || m->set[id] > 0) return NONE;
    for (b = 0; b < m->pass->binding_count && b < HBIL_MAX_BINDINGS; ++b)
        if (m->pass->bindings[b].slot == m->binding[id] && m->pass->bindings[b].access == kind
            && m->pass->bindings[b].texture < HBIL_MAX_TEXTURES)
            return m->pass->bindings[b].texture;
    return NONE;
}

static double texel_bytes(const hbil_plan *plan, int texture)
{
    const uint32_t bytes = texture == NONE ? 0 : hbil_format_bytes((hbil_format)plan->textures[texture].format);
    return bytes ? bytes : texture != NONE && strcmp(plan->textures[texture].name, "depth") == 0 ? 4 : 8;
}

static void count_access(const module *m, uint32_t image, int access, cost_counts *c)
{
    const int texture = texture_of(m, image, access);
    const double bytes = texel_bytes(m->plan, texture);
    c->access[access] += 1;
    if (texture != NONE) c->texture[access][texture] += 1;
    if (access != COST_STORE) c->bytes_read += bytes;
    if (access == COST_STORE || access == COST_ATOMIC) c->bytes_written += bytes;
}

/* What is no arithmetic. 0: not one of these. */
static int count_memory(const module *m, uint32_t at, cost_counts *c)
{
    const uint32_t op = opcode(m, at);
    if (op >= SpvOpImageSampleImplicitLod && op <= SpvOpImageDrefGather) count_access(m, word(m, at, 3), COST_FETCH, c);
    else if (op == SpvOpImageRead) count_access(m, word(m, at, 3), COST_LOAD, c);
    else if (op == SpvOpImageWrite) count_access(m, word(m, at, 1), COST_STORE, c);
    else if ((op >= SpvOpAtomicLoad && op <= SpvOpAtomicXor) || op == SpvOpAtomicFAddEXT) {
        const uint32_t pointer = word(m, at, op == SpvOpAtomicStore ? 1 : 3);
        if (opcode(m, def(m, pointer)) == SpvOpImageTexelPointer) count_access(m, pointer, COST_ATOMIC, c);
        else c->shared += 2;
    } else if (op == SpvOpLoad || op == SpvOpStore) {
        const uint32_t of = variable(m, word(m, at, op == SpvOpLoad ? 3 : 1));
        if (word(m, of, 3) == SpvStorageClassWorkgroup) c->shared += components_of(m, word(m, at, 2));
    } else return 0;
    return 1;
}

/* n: components of the result, k: of the first argument. */
static void count_glsl(uint32_t name, double n, double k, double ops[COST_CLASSES])
{
    switch (name) {
    case GLSLstd450FAbs: case GLSLstd450SAbs: break;
    case GLSLstd450Round: case GLSLstd450RoundEven: case GLSLstd450Trunc: case GLSLstd450Floor: case GLSLstd450Ceil:
    case GLSLstd450Fract: case GLSLstd450Modf: case GLSLstd450ModfStruct: case GLSLstd450Frexp:
    case GLSLstd450FrexpStruct: case GLSLstd450Ldexp: ops[COST_CONVERT] += n; break;
    case GLSLstd450Sqrt: case GLSLstd450InverseSqrt: ops[COST_ROOT] += n; break;
    case GLSLstd450FSign: case GLSLstd450SSign: case GLSLstd450Step:
    case GLSLstd450FMin: case GLSLstd450UMin: case GLSLstd450SMin: case GLSLstd450NMin:
    case GLSLstd450FMax: case GLSLstd450UMax: case GLSLstd450SMax: case GLSLstd450NMax: ops[COST_COMPARE] += n; break;
    case GLSLstd450FClamp: case GLSLstd450UClamp: case GLSLstd450SClamp: case GLSLstd450NClamp:
        ops[COST_COMPARE] += 2 * n;
        break;
    case GLSLstd450FMix: ops[COST_FLOAT] += 3 * n; break;
    case GLSLstd450Fma: ops[COST_FLOAT] += 2 * n; break;
    case GLSLstd450SmoothStep: ops[COST_FLOAT] += 6 * n; ops[COST_DIVIDE] += n; ops[COST_COMPARE] += 2 * n; break;
    case GLSLstd450Length: ops[COST_FLOAT] += 2 * k - 1; ops[COST_ROOT] += 1; break;
    case GLSLstd450Distance: ops[COST_FLOAT] += 3 * k - 1; ops[COST_ROOT] += 1; break;
    case GLSLstd450Normalize: ops[COST_FLOAT] += 3 * n - 1; ops[COST_ROOT] += 1; break;
    case GLSLstd450Cross: ops[COST_FLOAT] += 9; break;
    case GLSLstd450Reflect: ops[COST_FLOAT] += 4 * n; break;
    case GLSLstd450FindILsb: case GLSLstd450FindSMsb: case GLSLstd450FindUMsb: ops[COST_INTEGER] += n; break;
    default:
        if (name >= GLSLstd450Sin && name <= GLSLstd450Log2) ops[COST_TRANSCENDENTAL] += n;
        else if (name >= GLSLstd450PackSnorm4x8 && name <= GLSLstd450UnpackDouble2x32)
            ops[COST_CONVERT] += n > k ? n : k;
        else ops[COST_FLOAT] += n; /* radians, degrees, and what no pass has */
    }
}

static int is_constant(const module *m, uint32_t id)
{
    const uint32_t op = opcode(m, def(m, id));
    return op >= SpvOpConstantTrue && op <= SpvOpSpecConstantOp;
}

static void count_arithmetic(const module *m, uint32_t at, double ops[COST_CLASSES])
{
    const uint32_t op = opcode(m, at), a = word(m, at, 3), b = word(m, at, 4);
    const double n = result_at(op) == 2 ? components(m, word(m, at, 1), 0) : 0, k = components_of(m, a);
    switch (op) {
    case SpvOpFAdd: case SpvOpFSub: case SpvOpFMul: case SpvOpVectorTimesScalar: case SpvOpMatrixTimesScalar:
    case SpvOpOuterProduct: ops[COST_FLOAT] += n; return;
    case SpvOpDot: ops[COST_FLOAT] += 2 * k - 1; return;
    case SpvOpVectorTimesMatrix: ops[COST_FLOAT] += n * (2 * k - 1); return;
    case SpvOpMatrixTimesVector: ops[COST_FLOAT] += n * (2.0 * components_of(m, b) - 1); return;
    case SpvOpMatrixTimesMatrix: { /* a column of the result per column of b */
        const double columns = word(m, def(m, word(m, def(m, b), 1)), 3);
        ops[COST_FLOAT] += columns > 0 ? n * (2.0 * components_of(m, b) / columns - 1) : 0;
        return; }
    case SpvOpFDiv: case SpvOpFRem: case SpvOpFMod: ops[COST_DIVIDE] += n; return;
    case SpvOpUDiv: case SpvOpSDiv: case SpvOpUMod: case SpvOpSRem: case SpvOpSMod:
        ops[is_constant(m, b) ? COST_INTEGER : COST_DIVIDE] += n;
        return;
    case SpvOpIAdd: case SpvOpISub: case SpvOpIMul: case SpvOpSNegate: case SpvOpIAddCarry: case SpvOpISubBorrow:
    case SpvOpUMulExtended: case SpvOpSMulExtended: ops[COST_INTEGER] += n; return;
    case SpvOpAny: case SpvOpAll: ops[COST_COMPARE] += k; return;
    case SpvOpBranchConditional: ops[COST_BRANCH] += 1; return;
    case SpvOpSwitch: ops[COST_BRANCH] += length(m, at) > 3; return; /* one target alone is a way to leave a block */
    case SpvOpExtInst:
        if (m->glsl && a == m->glsl) count_glsl(b, n, components_of(m, word(m, at, 5)), ops);
        return;
    default: break;
    }
    if (op >= SpvOpConvertFToU && op <= SpvOpQuantizeToF16) ops[COST_CONVERT] += n;
    else if (op >= SpvOpShiftRightLogical && op <= SpvOpBitCount) ops[COST_INTEGER] += n;
    else if (op >= SpvOpImageQuerySizeLod && op <= SpvOpImageQuerySamples) ops[COST_INTEGER] += n;
    else if (op >= SpvOpIsNan && op <= SpvOpFUnordGreaterThanEqual) ops[COST_COMPARE] += n;
}

/* ------------------------------------------------------------------------------------------- blocks of one function */

typedef struct block {
    uint32_t label, at, end; /* at: its OpLabel, end: its terminator */
    int first, succs;        /* into flow.succ */
    int order;               /* place in reverse postorder, NONE: unreachable */
    int idom, loop;          /* innermost loop that it is in, NONE */
} block;

typedef struct loop {
    int header, parent;
    int test;      /* block whose branch ends it after `trips` rounds */
    int trips;     /* NONE: unknown */
    int slot;      /* among the loops of unknown length */
    cost_counts all[2]; /* all rounds and the last one, which ends by a branch elsewhere; by the test */
} loop;

/* What is known of a 32-bit scalar. */
typedef struct value { int known; uint32_t bits; } value;

/* An induction variable: its id, that of its next value, its value now. */
typedef struct phi { uint32_t id, next; value now; } phi;

typedef struct flow {
    module  *m;
    block   *blocks;
    int     *succ, *order, *preds, *pred_first;
    int      count, succ_count, reached, loop_count;
    loop    *loops;
    phi     *phis;  /* of the loop that is being run */
    int      phi_count;
    cost_counts *path; /* by block: the most that leads there and through it, within its region */
    int      call_registers;
} flow;

static int is_terminator(uint32_t op)
{
    return (op >= SpvOpBranch && op <= SpvOpUnreachable) || op == SpvOpTerminateInvocation;
}

/* Finds the blocks of the function at `at`. */
static int read_blocks(flow *f, uint32_t at)
{
    module *m = f->m;
    int open = 0;
    const uint32_t start = at;
    for (; at < m->count && opcode(m, at) != SpvOpFunctionEnd; at += length(m, at))
        f->count += opcode(m, at) == SpvOpLabel;
    if (at >= m->count) return fail(m, "a function without an end");
    if (f->count == 0 || f->count > BLOCKS_MAX) return fail(m, "a function without blocks, or with too many");
    f->blocks = (block *)calloc((size_t)f->count, sizeof *f->blocks);
    if (!f->blocks) return fail(m, "out of memory");
    f->count = 0;
    for (at = start; opcode(m, at) != SpvOpFunctionEnd; at += length(m, at)) {
        const uint32_t op = opcode(m, at);
        if (at != start && op == SpvOpFunction) return fail(m, "a function within another");
        if (op == SpvOpLabel) {
            block *b = &f->blocks[f->count];
            if (open) return fail(m, "a block without an end");
            b->label = word(m, at, 1);
            b->at = at;
            m->block[b->label] = f->count++;
            open = 1;
        } else if (is_terminator(op)) {
            if (!open) return fail(m, "a branch outside of a block");
            f->blocks[f->count - 1].end = at;
            open = 0;
        }
    }
    return open ? fail(m, "a block without an end") : 1;
}

static int block_of(const flow *f, uint32_t label)
{
    const int b = label < f->m->bound ? f->m->block[label] : NONE;
    return b >= 0 && b < f->count && f->blocks[b].label == label ? b : NONE;
}

/* Is operand word k of a terminator a label? */
static int is_target(uint32_t op, uint32_t k)
{
    return op == SpvOpBranch ? k == 1 : op == SpvOpBranchConditional ? k == 2 || k == 3 :
           op == SpvOpSwitch ? k >= 2 && k % 2 == 0 : 0; /* selectors have 32 bits */
}

static int read_edges(flow *f)
{
    module *m = f->m;
    uint32_t k, room = 0;
    int b;
    for (b = 0; b < f->count; ++b) room += length(m, f->blocks[b].end);
    f->succ = (int *)malloc((room + 1) * sizeof *f->succ);
    if (!f->succ) return fail(m, "out of memory");
    for (b = 0; b < f->count; ++b) {
        const uint32_t at = f->blocks[b].end;
        f->blocks[b].first = f->succ_count;
        for (k = 1; k < length(m, at); ++k) {
            if (!is_target(opcode(m, at), k)) continue;
            f->succ[f->succ_count] = block_of(f, word(m, at, k));
            if (f->succ[f->succ_count++] == NONE) return fail(m, "a branch to nowhere");
        }
        f->blocks[b].succs = f->succ_count - f->blocks[b].first;
    }
    return 1;
}

/* f->order: the blocks that are reached, each before its successors but for back edges. */
static int sort_blocks(flow *f)
{
    int *stack = (int *)malloc(3 * (size_t)f->count * sizeof *stack), *next = stack + f->count, *post = next + f->count;
    int depth = 1, done = 0, b, k;
    f->order = (int *)malloc((size_t)f->count * sizeof *f->order);
    if (!stack || !f->order) { free(stack); return fail(f->m, "out of memory"); }
    for (b = 0; b < f->count; ++b) next[b] = f->blocks[b].order = f->blocks[b].loop = f->blocks[b].idom = NONE;
    stack[0] = 0;
    next[0] = 0;
    while (depth) {
        b = stack[depth - 1];
        if (next[b] < f->blocks[b].succs) {
            /* the last first: what follows a loop then comes behind it */
            const int s = f->succ[f->blocks[b].first + f->blocks[b].succs - 1 - next[b]++];
            if (next[s] == NONE) { next[s] = 0; stack[depth++] = s; }
        } else {
            post[done++] = b;
            --depth;
        }
    }
    f->reached = done;
    for (k = 0; k < done; ++k) {
        f->order[k] = post[done - 1 - k];
        f->blocks[f->order[k]].order = k;
    }
    free(stack);
    return 1;
}

/* f->preds: those that are reached, of block b from pred_first[b] to pred_first[b + 1]. */
static int find_predecessors(flow *f)
{
    int b, k, *first = (int *)calloc((size_t)f->count + 2, sizeof *first);
    f->preds = (int *)malloc(((size_t)f->succ_count + 1) * sizeof *f->preds);
    f->pred_first = first;
    if (!first || !f->preds) return fail(f->m, "out of memory");
    for (b = 0; b < f->count; ++b)
        for (k = 0; f->blocks[b].order != NONE && k < f->blocks[b].succs; ++k)
            ++first[f->succ[f->blocks[b].first + k] + 2];
    for (b = 0; b < f->count; ++b) first[b + 2] += first[b + 1];
    for (b = 0; b < f->count; ++b)
        for (k = 0; f->blocks[b].order != NONE && k < f->blocks[b].succs; ++k)
            f->preds[first[f->succ[f->blocks[b].first + k] + 1]++] = b;
    return 1;
}

static int common(const flow *f, int a, int b)
{
    while (a != b) {
        while (f->blocks[a].order > f->blocks[b].order) a = f->blocks[a].idom;
        while (f->blocks[b].order > f->blocks[a].order) b = f->blocks[b].idom;
    }
    return a;
}

/* Cooper, Harvey, Kennedy 2001. */
static void find_dominators(flow *f)
{
    int changed = 1, k, p;
    f->blocks[0].idom = 0;
    while (changed) {
        changed = 0;
        for (k = 1; k < f->reached; ++k) {
            const int b = f->order[k];
            int idom = NONE;
            for (p = f->pred_first[b]; p < f->pred_first[b + 1]; ++p) {
                const int from = f->preds[p];
                if (f->blocks[from].idom != NONE) idom = idom == NONE ? from : common(f, idom, from);
            }
            if (f->blocks[b].idom != idom) { f->blocks[b].idom = idom; changed = 1; }
        }
    }
}

static int dominates(const flow *f, int a, int b)
{
    while (f->blocks[b].order > f->blocks[a].order) b = f->blocks[b].idom;
    return a == b;
}

/* ------------------------------------------------------------------------------------------------------------ loops */

static int is_in(const flow *f, int inner, int outer)
{
    while (inner != NONE && inner != outer) inner = f->loops[inner].parent;
    return inner == outer;
}

static int outermost(const flow *f, int l)
{
    while (f->loops[l].parent != NONE) l = f->loops[l].parent;
    return l;
}

/* Takes up the blocks from which the back edges of a loop are reached, and the loops that they are in. */
static void fill_loop(flow *f, int l, int *stack)
{
    const int header = f->loops[l].header;
    int depth = 0, p;
    for (p = f->pred_first[header]; p < f->pred_first[header + 1]; ++p)
        if (dominates(f, header, f->preds[p])) stack[depth++] = f->preds[p];
    f->blocks[header].loop = l;
    while (depth) {
        int b = stack[--depth];
        if (f->blocks[b].loop != NONE) { /* an inner loop, or taken already */
            const int inner = outermost(f, f->blocks[b].loop);
            if (inner == l) continue;
            f->loops[inner].parent = l;
            b = f->loops[inner].header;
        } else f->blocks[b].loop = l;
        for (p = f->pred_first[b]; p < f->pred_first[b + 1]; ++p) stack[depth++] = f->preds[p];
    }
}

/* Innermost loops come first. */
static int find_loops(flow *f)
{
    int *stack = (int *)malloc(((size_t)f->succ_count * 2 + 2) * sizeof *stack), k, p, ok = 1;
    f->loops = (loop *)calloc((size_t)f->count, sizeof *f->loops);
    if (!stack || !f->loops) ok = fail(f->m, "out of memory");
    for (k = f->reached - 1; k >= 0 && ok; --k) {
        const int b = f->order[k];
        int back = 0;
        for (p = f->pred_first[b]; p < f->pred_first[b + 1]; ++p) {
            if (f->blocks[f->preds[p]].order < k) continue;
            back = 1;
            if (!dominates(f, b, f->preds[p])) ok = fail(f->m, "control flow that is not structured");
        }
        if (!back || !ok) continue;
        f->loops[f->loop_count].header = b;
        f->loops[f->loop_count].parent = f->loops[f->loop_count].slot = NONE;
        fill_loop(f, f->loop_count++, stack);
    }
    free(stack);
    return ok;
}

/* --------------------------------------------------------------------------------- values that are known beforehand */

static value eval(const flow *f, uint32_t id, int *budget);

static value known(uint32_t bits) { const value v = { 1, bits }; return v; }
static value unknown(void)        { const value v = { 0, 0 }; return v; }
static value truth(int holds)     { return known(holds != 0); }

static float    to_float(uint32_t bits) { float x; memcpy(&x, &bits, sizeof x); return x; }
static uint32_t to_bits(float x)        { uint32_t bits; memcpy(&bits, &x, sizeof bits); return bits; }
static int32_t  to_int(uint32_t bits)   { int32_t x; memcpy(&x, &bits, sizeof x); return x; }

static value of_float(float x) { return isfinite(x) ? known(to_bits(x)) : unknown(); }

static value divide(uint32_t op, uint32_t a, uint32_t b)
{
    const int32_t x = to_int(a), y = to_int(b);
    if (b == 0) return unknown();
    if (op == SpvOpUDiv) return known(a / b);
    if (op == SpvOpUMod) return known(a % b);
    if (x < 0 || y < 0) return unknown(); /* no pass counts so */
    return known(op == SpvOpSDiv ? a / b : a % b);
}

static value of_integers(uint32_t op, uint32_t a, uint32_t b)
{
    switch (op) {
    case SpvOpIAdd: return known(a + b);
    case SpvOpISub: return known(a - b);
    case SpvOpIMul: return known(a * b);
    case SpvOpUDiv: case SpvOpSDiv: case SpvOpUMod: case SpvOpSMod: case SpvOpSRem: return divide(op, a, b);
    case SpvOpShiftLeftLogical: return b < 32 ? known(a << b) : unknown();
    case SpvOpShiftRightLogical: return b < 32 ? known(a >> b) : unknown();
    case SpvOpShiftRightArithmetic:
        return b < 32 ? known((a >> b) | (to_int(a) < 0 ? ~(0xffffffffu >> b) : 0)) : unknown();
    case SpvOpBitwiseAnd: return known(a & b);
    case SpvOpBitwiseOr: return known(a | b);
    case SpvOpBitwiseXor: return known(a ^ b);
    case SpvOpIEqual: return truth(a == b);
    case SpvOpINotEqual: return truth(a != b);
    case SpvOpULessThan: return truth(a < b);
    case SpvOpULessThanEqual: return truth(a <= b);
    case SpvOpUGreaterThan: return truth(a > b);
    case SpvOpUGreaterThanEqual: return truth(a >= b);
    case SpvOpSLessThan: return truth(to_int(a) < to_int(b));
    case SpvOpSLessThanEqual: return truth(to_int(a) <= to_int(b));
    case SpvOpSGreaterThan: return truth(to_int(a) > to_int(b));
    case SpvOpSGreaterThanEqual: return truth(to_int(a) >= to_int(b));
    default: return unknown();
    }
}

static value of_floats(uint32_t op, float a, float b)
{
    switch (op) {
    case SpvOpFAdd: return of_float(a + b);
    case SpvOpFSub: return of_float(a - b);
    case SpvOpFMul: return of_float(a * b);
    case SpvOpFDiv: return b < 0 || b > 0 ? of_float(a / b) : unknown();
    case SpvOpFOrdLessThan: case SpvOpFUnordLessThan: return truth(a < b);
    case SpvOpFOrdLessThanEqual: case SpvOpFUnordLessThanEqual: return truth(a <= b);
    case SpvOpFOrdGreaterThan: case SpvOpFUnordGreaterThan: return truth(a > b);
    case SpvOpFOrdGreaterThanEqual: case SpvOpFUnordGreaterThanEqual: return truth(a >= b);
    default: return of_integers(op, to_bits(a), to_bits(b));
    }
}

static value of_glsl(uint32_t name, uint32_t a, uint32_t b)
{
    switch (name) {
    case GLSLstd450UMin: return known(a < b ? a : b);
    case GLSLstd450UMax: return known(a > b ? a : b);
    case GLSLstd450SMin: return known(to_int(a) < to_int(b) ? a : b);
    case GLSLstd450SMax: return known(to_int(a) > to_int(b) ? a : b);
    case GLSLstd450FMin: return known(to_float(a) < to_float(b) ? a : b);
    case GLSLstd450FMax: return known(to_float(a) > to_float(b) ? a : b);
    default: return unknown();
    }
}

static value convert(uint32_t op, uint32_t a)
{
    const float x = to_float(a);
    switch (op) {
    case SpvOpConvertSToF: return known(to_bits((float)to_int(a)));
    case SpvOpConvertUToF: return known(to_bits((float)a));
    case SpvOpConvertFToS: return x > -2e9f && x < 2e9f ? known((uint32_t)(int32_t)x) : unknown();
    case SpvOpConvertFToU: return x > -1 && x < 4e9f ? known((uint32_t)x) : unknown();
    case SpvOpSNegate: return known(0u - a);
    case SpvOpFNegate: return known(a ^ 0x80000000u);
    case SpvOpNot: return known(~a);
    case SpvOpLogicalNot: return truth(!a);
    default: return known(a); /* a copy, a cast of bits */
    }
}

/* The config's value of a dynamic option, read from the uniform block. */
static value option_value(const flow *f, uint32_t pointer, int *budget)
{
    const module *m = f->m;
    const uint32_t chain = def(m, pointer), base = def(m, word(m, chain, 3));
    const uint32_t type = word(m, def(m, word(m, base, 1)), 3), id = word(m, base, 2);
    value member;
    uint32_t at, offset, k, bits;
    if (opcode(m, chain) != SpvOpAccessChain || length(m, chain) != 5) return unknown();
    if (opcode(m, base) != SpvOpVariable || word(m, base, 3) != SpvStorageClassUniform) return unknown();
    if (m->set[id] > 0 || m->binding[id] != (int32_t)m->plan->constants_slot || !m->pass->constants) return unknown();
    member = eval(f, word(m, chain, 4), budget);
    if (!member.known) return unknown();
    for (at = 5; at < m->count; at += length(m, at))
        if (opcode(m, at) == SpvOpMemberDecorate && word(m, at, 1) == type && word(m, at, 2) == member.bits
            && word(m, at, 3) == SpvDecorationOffset) break;
    if (at >= m->count) return unknown();
    offset = word(m, at, 4);
    for (k = 0; k < m->plan->constant_count && k < HBIL_MAX_CONSTANTS; ++k) {
        const hbil_option *o = hbil_option_at(m->plan->constants[k].option);
        if (m->plan->constants[k].offset != offset || !o) continue;
        memcpy(&bits, (const char *)&m->plan->config + o->offset, sizeof bits);
        return known(bits);
    }
    return unknown();
}

/* A phi behind a branch whose condition is known, as && and || make them. */
static value eval_phi(const flow *f, uint32_t at, int *budget)
{
    const module *m = f->m;
    uint32_t k, taken = 0, branch;
    int b = NONE, idom, side, p, n;
    value c;
    for (n = 0; n < f->count && b == NONE; ++n) /* the block it is in */
        if (f->blocks[n].at < at && at < f->blocks[n].end) b = n;
    if (b == NONE || f->blocks[b].order <= 0) return unknown();
    if (f->blocks[b].loop != NONE && f->loops[f->blocks[b].loop].header == b) return unknown();
    idom = f->blocks[b].idom;
    branch = f->blocks[idom].end;
    if (opcode(m, branch) != SpvOpBranchConditional) return unknown();
    c = eval(f, word(m, branch, 1), budget);
    side = c.known ? block_of(f, word(m, branch, c.bits ? 2 : 3)) : NONE;
    if (side == NONE) return unknown();
    for (k = 3; k + 1 < length(m, at); k += 2) {
        p = block_of(f, word(m, at, k + 1));
        if (p == NONE || f->blocks[p].order == NONE) return unknown();
        if (side == b ? p != idom : !dominates(f, side, p)) continue;
        if (taken) return unknown();
        taken = word(m, at, k);
    }
    return taken ? eval(f, taken, budget) : unknown();
}

/* false && x and true || x are known whatever x is. */
static value eval_logic(uint32_t op, value a, value b)
{
    const uint32_t wins = op == SpvOpLogicalOr;
    if (op == SpvOpLogicalAnd || op == SpvOpLogicalOr) {
        if ((a.known && a.bits == wins) || (b.known && b.bits == wins)) return known(wins);
        return a.known && b.known ? known(!wins) : unknown();
    }
    if (!a.known || !b.known) return unknown();
    return truth(op == SpvOpLogicalEqual ? a.bits == b.bits : a.bits != b.bits);
}

static int is_float(const module *m, uint32_t id)
{
    return opcode(m, def(m, word(m, def(m, id), 1))) == SpvOpTypeFloat;
}

static value eval_operation(const flow *f, uint32_t at, int *budget)
{
    const module *m = f->m;
    const uint32_t op = opcode(m, at);
    value a, b;
    if (op == SpvOpExtInst) {
        a = eval(f, word(m, at, 5), budget);
        b = eval(f, word(m, at, 6), budget);
        return word(m, at, 3) == m->glsl && a.known && b.known ? of_glsl(word(m, at, 4), a.bits, b.bits) : unknown();
    }
    a = eval(f, word(m, at, 3), budget);
    if (op == SpvOpSelect)
        return a.known ? eval(f, word(m, at, a.bits ? 4 : 5), budget) : unknown();
    if (length(m, at) == 4) {
        const int one = op == SpvOpCopyObject || op == SpvOpBitcast || op == SpvOpSNegate || op == SpvOpFNegate
                     || op == SpvOpNot || op == SpvOpLogicalNot || (op >= SpvOpConvertFToU && op <= SpvOpConvertUToF);
        return one && a.known ? convert(op, a.bits) : unknown();
    }
    if (length(m, at) != 5) return unknown();
    b = eval(f, word(m, at, 4), budget);
    if (op >= SpvOpLogicalEqual && op <= SpvOpLogicalAnd) return eval_logic(op, a, b);
    if (!a.known || !b.known) return unknown();
    if (is_float(m, word(m, at, 3))) return of_floats(op, to_float(a.bits), to_float(b.bits));
    return of_integers(op, a.bits, b.bits);
}

/* A scalar of 32 bits or a bool. budget: instructions that may still be looked at. */
static value eval(const flow *f, uint32_t id, int *budget)
{
    const module *m = f->m;
    const uint32_t at = def(m, id), op = opcode(m, at);
    uint32_t from;
    int k;
    if (--*budget < 0 || result_at(op) != 2 || components_of(m, id) != 1) return unknown();
    for (k = 0; k < f->phi_count; ++k)
        if (f->phis[k].id == id) return f->phis[k].now;
    switch (op) {
    case SpvOpConstant: case SpvOpSpecConstant: return known(word(m, at, 3));
    case SpvOpConstantTrue: case SpvOpSpecConstantTrue: return known(1);
    case SpvOpConstantFalse: case SpvOpSpecConstantFalse: case SpvOpConstantNull: return known(0);
    case SpvOpLoad: return option_value(f, word(m, at, 3), budget);
    case SpvOpPhi: return eval_phi(f, at, budget);
    case SpvOpCompositeExtract: /* of what is made of scalars */
        from = def(m, word(m, at, 3));
        if (opcode(m, from) != SpvOpConstantComposite && opcode(m, from) != SpvOpCompositeConstruct) return unknown();
        if (length(m, at) != 5 || length(m, from) - 3 != (uint32_t)components_of(m, word(m, at, 3))) return unknown();
        return word(m, at, 4) < length(m, from) ? eval(f, word(m, from, 3 + word(m, at, 4)), budget) : unknown();
    default: return eval_operation(f, at, budget);
    }
}

/* ------------------------------------------------------------------------------------------------------ trip counts */

static value eval_id(const flow *f, uint32_t id)
{
    int budget = 512;
    return eval(f, id, &budget);
}

/* The phis of a loop's header with their first values. */
static void start_phis(flow *f, int l)
{
    const module *m = f->m;
    const int header = f->loops[l].header;
    uint32_t at, k;
    int count = 0;
    f->phi_count = 0;
    for (at = f->blocks[header].at; at < f->blocks[header].end; at += length(m, at)) {
        phi p = { 0, 0, { 0, 0 } };
        uint32_t first = 0;
        int single = 1;
        if (opcode(m, at) != SpvOpPhi || components_of(m, word(m, at, 2)) != 1) continue;
        p.id = word(m, at, 2);
        for (k = 3; k + 1 < length(m, at); k += 2) {
            const int b = block_of(f, word(m, at, k + 1)), inside = b != NONE && is_in(f, f->blocks[b].loop, l);
            uint32_t *to = inside ? &p.next : &first;
            if (*to && *to != word(m, at, k)) single = 0;
            *to = word(m, at, k);
        }
        if (!single) continue;
        p.now = eval_id(f, first);
        f->phis[count++] = p;
    }
    f->phi_count = count;
}

static int step_phis(flow *f)
{
    int k, alive = 0;
    for (k = 0; k < f->phi_count; ++k) { /* all from the old values */
        const value next = f->phis[k].now.known ? eval_id(f, f->phis[k].next) : unknown();
        f->phis[f->phi_count + k].now = next;
        alive += next.known;
    }
    for (k = 0; k < f->phi_count; ++k) f->phis[k].now = f->phis[f->phi_count + k].now;
    return alive;
}

/* Does the branch of block b leave the loop in every round that gets to it, and all rounds do? */
static int is_test(const flow *f, int l, int b)
{
    const module *m = f->m;
    const int header = f->loops[l].header;
    int p, out = 0, k;
    if (f->blocks[b].loop != l || opcode(m, f->blocks[b].end) != SpvOpBranchConditional) return 0;
    for (k = 0; k < 2; ++k) out += !is_in(f, f->blocks[f->succ[f->blocks[b].first + k]].loop, l);
    for (p = f->pred_first[header]; p < f->pred_first[header + 1]; ++p)
        if (is_in(f, f->blocks[f->preds[p]].loop, l) && !dominates(f, b, f->preds[p])) return 0;
    return out == 1;
}

/* Runs the induction variables until a test is known to end the loop. */
static void count_trips(flow *f, int l)
{
    const module *m = f->m;
    loop *to = &f->loops[l];
    int *tests = (int *)malloc((size_t)f->count * sizeof *tests), count = 0, b, k, n;
    to->trips = to->test = NONE;
    for (b = 0; b < f->count && tests; ++b)
        if (f->blocks[b].order != NONE && is_test(f, l, b)) tests[count++] = b;
    start_phis(f, l);
    for (n = 0; count && n < TRIPS_MAX && to->trips == NONE; ++n) {
        for (k = 0; k < count && to->trips == NONE; ++k) {
            const block *t = &f->blocks[tests[k]];
            const value c = eval_id(f, word(m, t->end, 1));
            if (!c.known || is_in(f, f->blocks[f->succ[t->first + (c.bits ? 0 : 1)]].loop, l)) continue;
            to->trips = n;
            to->test = tests[k];
        }
        if (to->trips == NONE && !step_phis(f)) break;
    }
    f->phi_count = 0;
    free(tests);
}

/* -------------------------------------------------------------------------------------------- costs of one function */

static const function *count_function(module *m, uint32_t id, int depth);

/* What the instructions of a block do. */
static int count_block(flow *f, const block *b, int depth, cost_counts *c)
{
    module *m = f->m;
    uint32_t at;
    for (at = b->at; at <= b->end; at += length(m, at)) {
        if (opcode(m, at) == SpvOpFunctionCall) {
            const function *called = count_function(m, word(m, at, 3), depth + 1);
            if (!called) return 0;
            add(c, &called->counts, 1);
            if (called->registers > f->call_registers) f->call_registers = called->registers;
        } else if (!count_memory(m, at, c)) count_arithmetic(m, at, c->ops);
    }
    return 1;
}

/* The node of block b in the graph of a region (a loop, or NONE: the function), in which inner loops are one node,
 * their header. NONE: b is outside. */
static int node_of(const flow *f, int b, int region)
{
    int l = f->blocks[b].loop, inner = NONE;
    while (l != region && l != NONE) { inner = l; l = f->loops[l].parent; }
    return l != region ? NONE : inner == NONE ? b : f->loops[inner].header;
}

/* The most that one way through a region does. Inner loops have been counted. */
typedef struct region {
    cost_counts round;  /* from the header back to it */
    cost_counts test;   /* to the test and out */
    cost_counts before; /* out by other ways, which the last round may take too, */
    cost_counts after;  /* or not, since the test comes first */
    cost_counts most;   /* to anywhere */
    int         early;  /* there are such ways as `before` */
} region;

static int count_region(flow *f, int l, int depth, region *r)
{
    const int header = l == NONE ? 0 : f->loops[l].header, test = l == NONE ? NONE : f->loops[l].test;
    int k, e;
    memset(r, 0, sizeof *r);
    for (k = 0; k < f->reached; ++k)
        if (node_of(f, f->order[k], l) == f->order[k]) memset(&f->path[f->order[k]], 0, sizeof *f->path);
    for (k = f->blocks[header].order; k < f->reached; ++k) {
        const int b = f->order[k], node = node_of(f, b, l), inner = node == NONE ? NONE : f->blocks[node].loop;
        cost_counts here;
        if (node == NONE) continue;
        here = f->path[node];
        if (inner != l) add(&here, &f->loops[inner].all[b == f->loops[inner].test], 1);
        else if (!count_block(f, &f->blocks[b], depth, &here)) return 0;
        raise_to(&r->most, &here);
        for (e = 0; e < f->blocks[b].succs; ++e) {
            const int s = f->succ[f->blocks[b].first + e], to = node_of(f, s, l);
            if (l != NONE && s == header) raise_to(&r->round, &here);
            else if (to == NONE) {
                const int after = test != NONE && dominates(f, test, b);
                raise_to(b == test ? &r->test : after ? &r->after : &r->before, &here);
                r->early |= !after;
            } else if (to != node) raise_to(&f->path[to], &here);
        }
    }
    return 1;
}

/* The loop as one node: of a known number of rounds, or into the counts of its own. */
static int count_loop(flow *f, int l, int depth)
{
    loop *to = &f->loops[l];
    region r;
    if (!count_region(f, l, depth, &r)) return 0;
    if (to->trips == NONE) {
        f->m->out->step[to->slot] = r.most;
        to->all[0].enters[to->slot] = to->all[1].enters[to->slot] = 1;
        return 1;
    }
    to->all[1] = r.test;
    add(&to->all[1], &r.round, to->trips);
    if (to->trips > 0) { /* the last round that passes the test may end behind it */
        to->all[0] = r.after;
        add(&to->all[0], &r.round, to->trips - 1);
    }
    if (r.early) {
        add(&r.before, &r.round, to->trips);
        raise_to(&to->all[0], &r.before);
    }
    return 1;
}

static int count_loops(flow *f, int depth)
{
    module *m = f->m;
    int l;
    for (l = f->loop_count - 1; l >= 0; --l) { /* outer ones get the first slots */
        count_trips(f, l);
        if (f->loops[l].trips != NONE) continue;
        if (m->out->loops == COST_LOOPS_MAX) return fail(m, "more loops of unknown length than are kept apart");
        f->loops[l].slot = m->out->loops++;
    }
    for (l = 0; l < f->loop_count; ++l)
        if (!count_loop(f, l, depth)) return 0;
    return 1;
}

/* -------------------------------------------------------------------------------------------------------- registers */

typedef struct liveness {
    int       count, words; /* values; 64-bit words of a set */
    int32_t  *index;        /* by id, NONE */
    int32_t  *size;         /* components by value */
    uint64_t *in;           /* by block: alive where it begins, without its phis */
    uint64_t *now;
    int32_t   arrays, alive, most;
} liveness;

/* Is operand word k an id, and no literal? */
static int is_operand(uint32_t op, uint32_t k)
{
    switch (op) {
    case SpvOpLoad: return k == 3;
    case SpvOpStore: return k < 3;
    case SpvOpExtInst: return k > 4;
    case SpvOpCompositeExtract: return k == 3;
    case SpvOpCompositeInsert: case SpvOpVectorShuffle: return k == 3 || k == 4;
    case SpvOpImageWrite: return k != 4;
    case SpvOpImageRead: return k != 5;
    case SpvOpBranchConditional: case SpvOpSwitch: case SpvOpReturnValue: return k == 1;
    case SpvOpBranch: case SpvOpLabel: case SpvOpLoopMerge: case SpvOpSelectionMerge: case SpvOpPhi: return 0;
    case SpvOpImageGather: case SpvOpImageDrefGather: return k != 6;
    default: return op >= SpvOpImageSampleImplicitLod && op <= SpvOpImageFetch ? k != 5 : 1;
    }
}

static void set_alive(liveness *v, int32_t n, int alive)
{
    const uint64_t bit = (uint64_t)1 << (n % 64);
    uint64_t *at = &v->now[n / 64];
    if (((*at & bit) != 0) == alive) return;
    *at ^= bit;
    v->alive += alive ? v->size[n] : -v->size[n];
}

static int find_values(flow *f, liveness *v)
{
    const module *m = f->m;
    uint32_t at;
    int b, n = 0;
    for (b = 0; b < f->count; ++b)
        for (at = f->blocks[b].at; at <= f->blocks[b].end; at += length(m, at)) {
            const uint32_t id = word(m, at, 2);
            if (opcode(m, at) == SpvOpVariable) {
                v->arrays += components(m, word(m, def(m, word(m, at, 1)), 3), 0);
                continue;
            }
            if (f->blocks[b].order == NONE || result_at(opcode(m, at)) != 2 || !components_of(m, id)) continue;
            if (n == VALUES_MAX) return fail(f->m, "too many values in a function");
            v->size[n] = components_of(m, id);
            v->index[id] = n++;
        }
    v->count = n;
    v->words = n / 64 + 1;
    return 1;
}

/* Into v->now what is alive where block b ends. */
static void start_at_end(const flow *f, liveness *v, int b)
{
    const module *m = f->m;
    uint32_t at, k;
    int e, w;
    memset(v->now, 0, (size_t)v->words * sizeof *v->now);
    for (e = 0; e < f->blocks[b].succs; ++e) {
        const int s = f->succ[f->blocks[b].first + e];
        for (w = 0; w < v->words; ++w) v->now[w] |= v->in[(size_t)s * (size_t)v->words + (size_t)w];
    }
    v->alive = 0;
    for (w = 0; w < v->count; ++w)
        if (v->now[w / 64] >> (w % 64) & 1) v->alive += v->size[w];
    for (e = 0; e < f->blocks[b].succs; ++e) {
        const block *s = &f->blocks[f->succ[f->blocks[b].first + e]];
        for (at = s->at; at < s->end; at += length(m, at))
            for (k = 3; opcode(m, at) == SpvOpPhi && k + 1 < length(m, at); k += 2) {
                const uint32_t id = word(m, at, k);
                if (word(m, at, k + 1) == f->blocks[b].label && id < m->bound && v->index[id] != NONE)
                    set_alive(v, v->index[id], 1);
            }
    }
}

/* Backwards through a block. list: room for the instructions of the longest block. */
static int live_block(const flow *f, liveness *v, int b, uint32_t *list)
{
    const module *m = f->m;
    uint64_t *in = v->in + (size_t)b * (size_t)v->words;
    uint32_t at, k, n = 0;
    int changed;
    start_at_end(f, v, b);
    for (at = f->blocks[b].at; at <= f->blocks[b].end; at += length(m, at)) list[n++] = at;
    while (n--) {
        const uint32_t op = opcode(m, list[n]), r = result_at(op), id = word(m, list[n], 2);
        if (v->alive > v->most) v->most = v->alive;
        if (r == 2 && id < m->bound && v->index[id] != NONE) set_alive(v, v->index[id], 0);
        for (k = r + 1; k < length(m, list[n]); ++k) {
            const uint32_t from = word(m, list[n], k);
            if (is_operand(op, k) && from < m->bound && v->index[from] != NONE) set_alive(v, v->index[from], 1);
        }
    }
    if (v->alive > v->most) v->most = v->alive;
    changed = memcmp(in, v->now, (size_t)v->words * sizeof *in) != 0;
    memcpy(in, v->now, (size_t)v->words * sizeof *in);
    return changed;
}

static int count_registers(flow *f, int *registers)
{
    module *m = f->m;
    liveness v;
    uint32_t *list;
    int k, changed = 1, ok = 0;
    memset(&v, 0, sizeof v);
    v.index = (int32_t *)malloc(m->bound * sizeof *v.index);
    v.size = (int32_t *)malloc(VALUES_MAX * sizeof *v.size);
    list = (uint32_t *)malloc(m->count * sizeof *list);
    if (v.index && v.size && list) {
        memset(v.index, 0xff, m->bound * sizeof *v.index);
        ok = find_values(f, &v);
        v.in = (uint64_t *)calloc((size_t)(v.words + 1) * ((size_t)f->count + 1), sizeof *v.in);
        v.now = v.in ? v.in + (size_t)f->count * (size_t)v.words : NULL;
    }
    if (!v.now) ok = fail(m, "out of memory");
    while (ok && changed) {
        v.most = 0;
        changed = 0;
        for (k = f->reached - 1; k >= 0; --k) changed |= live_block(f, &v, f->order[k], list);
    }
    *registers = v.most + v.arrays + f->call_registers;
    free(v.index);
    free(v.size);
    free(v.in);
    free(list);
    return ok;
}

/* ---------------------------------------------------------------------------------------------------------- modules */

static void free_flow(flow *f)
{
    free(f->blocks);
    free(f->succ);
    free(f->order);
    free(f->preds);
    free(f->pred_first);
    free(f->loops);
    free(f->phis);
    free(f->path);
}

static int count_flow(flow *f, uint32_t at, int depth, function *to)
{
    region r;
    uint32_t k, phis = 1;
    if (!read_blocks(f, at) || !read_edges(f) || !sort_blocks(f) || !find_predecessors(f)) return 0;
    find_dominators(f);
    if (!find_loops(f)) return 0;
    for (k = at; k < f->m->count && opcode(f->m, k) != SpvOpFunctionEnd; k += length(f->m, k))
        phis += opcode(f->m, k) == SpvOpPhi;
    f->phis = (phi *)calloc(2 * phis, sizeof *f->phis);
    f->path = (cost_counts *)calloc((size_t)f->count, sizeof *f->path);
    if (!f->phis || !f->path) return fail(f->m, "out of memory");
    if (!count_loops(f, depth) || !count_region(f, NONE, depth, &r)) return 0;
    to->counts = r.most;
    return count_registers(f, &to->registers);
}

/* Each function once; NULL: out->error says why. */
static const function *count_function(module *m, uint32_t id, int depth)
{
    flow f;
    uint32_t k;
    int ok;
    for (k = 0; k < m->function_count && m->functions[k].id != id; ++k) { }
    if (k == m->function_count) { fail(m, "a call of what is no function"); return NULL; }
    if (m->functions[k].state == 2) return &m->functions[k];
    if (m->functions[k].state == 1 || depth > 32) { fail(m, "a function that calls itself"); return NULL; }
    m->functions[k].state = 1;
    memset(&f, 0, sizeof f);
    f.m = m;
    ok = count_flow(&f, def(m, id), depth, &m->functions[k]);
    free_flow(&f);
    m->functions[k].state = 2;
    return ok ? &m->functions[k] : NULL;
}

int cost_of_words(const hbil_plan *plan, int32_t pass, const uint32_t *words, size_t count, cost *out)
{
    module m;
    const function *main_function = NULL;
    memset(out, 0, sizeof *out);
    memset(&m, 0, sizeof m);
    m.plan = plan;
    m.words = words;
    m.out = out;
    if (!plan || pass < 0 || pass >= (int32_t)plan->pass_count || plan->pass_count > HBIL_MAX_PASSES || !words)
        return fail(&m, "no such pass, or no words");
    m.pass = &plan->passes[pass];
    if (count < 5 || count > WORDS_MAX || words[0] != SpvMagicNumber) return fail(&m, "no SPIR-V, or too much of it");
    m.count = (uint32_t)count;
    m.bound = words[3];
    if (m.bound == 0 || m.bound > BOUND_MAX) return fail(&m, "more ids than a shader has");
    if (read_module(&m)) main_function = count_function(&m, m.entry, 0);
    if (main_function) {
        out->fixed = main_function->counts;
        out->registers = main_function->registers;
    }
    free(m.def);
    free(m.binding);
    free(m.functions);
    return main_function != NULL;
}
