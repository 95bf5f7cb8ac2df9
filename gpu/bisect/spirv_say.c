#include "gpu/bisect/spirv_say.h"

#include "ref/base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The opcodes that shaders of this program have, before and after optimisers. Operands: t the type
 * of the result, r the result, i an id, I ids to the end, l a number, L numbers to the end, x the
 * number of an extended instruction, d a decoration, s a string. */
static const struct opcode {
    uint16_t number;
    const char *name, *operands;
} opcodes[] = {
    {1, "OpUndef", "tr"},
    {5, "OpName", "is"},
    {10, "OpExtension", "s"},
    {11, "OpExtInstImport", "rs"},
    {12, "OpExtInst", "trixI"},
    {14, "OpMemoryModel", "ll"},
    {15, "OpEntryPoint", "lis"},
    {16, "OpExecutionMode", "ilL"},
    {17, "OpCapability", "l"},
    {19, "OpTypeVoid", "r"},
    {20, "OpTypeBool", "r"},
    {21, "OpTypeInt", "rll"},
    {22, "OpTypeFloat", "rl"},
    {23, "OpTypeVector", "ril"},
    {24, "OpTypeMatrix", "ril"},
    {28, "OpTypeArray", "rii"},
    {29, "OpTypeRuntimeArray", "ri"},
    {30, "OpTypeStruct", "rI"},
    {32, "OpTypePointer", "rli"},
    {33, "OpTypeFunction", "rI"},
    {41, "OpConstantTrue", "tr"},
    {42, "OpConstantFalse", "tr"},
    {43, "OpConstant", "trL"},
    {44, "OpConstantComposite", "trI"},
    {46, "OpConstantNull", "tr"},
    {48, "OpSpecConstantTrue", "tr"},
    {49, "OpSpecConstantFalse", "tr"},
    {50, "OpSpecConstant", "trL"},
    {51, "OpSpecConstantComposite", "trI"},
    {52, "OpSpecConstantOp", "trlI"},
    {54, "OpFunction", "trli"},
    {55, "OpFunctionParameter", "tr"},
    {56, "OpFunctionEnd", ""},
    {57, "OpFunctionCall", "trI"},
    {59, "OpVariable", "trlI"},
    {61, "OpLoad", "triL"},
    {62, "OpStore", "iiL"},
    {63, "OpCopyMemory", "iiL"},
    {65, "OpAccessChain", "trI"},
    {66, "OpInBoundsAccessChain", "trI"},
    {68, "OpArrayLength", "tril"},
    {71, "OpDecorate", "idL"},
    {72, "OpMemberDecorate", "ildL"},
    {77, "OpVectorExtractDynamic", "trii"},
    {78, "OpVectorInsertDynamic", "triii"},
    {79, "OpVectorShuffle", "triiL"},
    {80, "OpCompositeConstruct", "trI"},
    {81, "OpCompositeExtract", "triL"},
    {82, "OpCompositeInsert", "triiL"},
    {83, "OpCopyObject", "tri"},
    {84, "OpTranspose", "tri"},
    {109, "OpConvertFToU", "tri"},
    {110, "OpConvertFToS", "tri"},
    {111, "OpConvertSToF", "tri"},
    {112, "OpConvertUToF", "tri"},
    {115, "OpFConvert", "tri"},
    {124, "OpBitcast", "tri"},
    {126, "OpSNegate", "tri"},
    {127, "OpFNegate", "tri"},
    {128, "OpIAdd", "trii"},
    {129, "OpFAdd", "trii"},
    {130, "OpISub", "trii"},
    {131, "OpFSub", "trii"},
    {132, "OpIMul", "trii"},
    {133, "OpFMul", "trii"},
    {134, "OpUDiv", "trii"},
    {135, "OpSDiv", "trii"},
    {136, "OpFDiv", "trii"},
    {137, "OpUMod", "trii"},
    {138, "OpSRem", "trii"},
    {139, "OpSMod", "trii"},
    {140, "OpFRem", "trii"},
    {141, "OpFMod", "trii"},
    {142, "OpVectorTimesScalar", "trii"},
    {143, "OpMatrixTimesScalar", "trii"},
    {144, "OpVectorTimesMatrix", "trii"},
    {145, "OpMatrixTimesVector", "trii"},
    {146, "OpMatrixTimesMatrix", "trii"},
    {147, "OpOuterProduct", "trii"},
    {148, "OpDot", "trii"},
    {149, "OpIAddCarry", "trii"},
    {150, "OpISubBorrow", "trii"},
    {151, "OpUMulExtended", "trii"},
    {152, "OpSMulExtended", "trii"},
    {154, "OpAny", "tri"},
    {155, "OpAll", "tri"},
    {156, "OpIsNan", "tri"},
    {157, "OpIsInf", "tri"},
    {164, "OpLogicalEqual", "trii"},
    {165, "OpLogicalNotEqual", "trii"},
    {166, "OpLogicalOr", "trii"},
    {167, "OpLogicalAnd", "trii"},
    {168, "OpLogicalNot", "tri"},
    {169, "OpSelect", "triii"},
    {170, "OpIEqual", "trii"},
    {171, "OpINotEqual", "trii"},
    {172, "OpUGreaterThan", "trii"},
    {173, "OpSGreaterThan", "trii"},
    {174, "OpUGreaterThanEqual", "trii"},
    {175, "OpSGreaterThanEqual", "trii"},
    {176, "OpULessThan", "trii"},
    {177, "OpSLessThan", "trii"},
    {178, "OpULessThanEqual", "trii"},
    {179, "OpSLessThanEqual", "trii"},
    {180, "OpFOrdEqual", "trii"},
    {181, "OpFUnordEqual", "trii"},
    {182, "OpFOrdNotEqual", "trii"},
    {183, "OpFUnordNotEqual", "trii"},
    {184, "OpFOrdLessThan", "trii"},
    {185, "OpFUnordLessThan", "trii"},
    {186, "OpFOrdGreaterThan", "trii"},
    {187, "OpFUnordGreaterThan", "trii"},
    {188, "OpFOrdLessThanEqual", "trii"},
    {189, "OpFUnordLessThanEqual", "trii"},
    {190, "OpFOrdGreaterThanEqual", "trii"},
    {191, "OpFUnordGreaterThanEqual", "trii"},
    {194, "OpShiftRightLogical", "trii"},
    {195, "OpShiftRightArithmetic", "trii"},
    {196, "OpShiftLeftLogical", "trii"},
    {197, "OpBitwiseOr", "trii"},
    {198, "OpBitwiseXor", "trii"},
    {199, "OpBitwiseAnd", "trii"},
    {200, "OpNot", "tri"},
    {201, "OpBitFieldInsert", "triiii"},
    {202, "OpBitFieldSExtract", "triii"},
    {203, "OpBitFieldUExtract", "triii"},
    {204, "OpBitReverse", "tri"},
    {205, "OpBitCount", "tri"},
    {224, "OpControlBarrier", "iii"},
    {225, "OpMemoryBarrier", "ii"},
    {234, "OpAtomicIAdd", "triiii"},
    {239, "OpAtomicUMax", "triiii"},
    {241, "OpAtomicOr", "triiii"},
    {245, "OpPhi", "trI"},
    {246, "OpLoopMerge", "iilL"},
    {247, "OpSelectionMerge", "il"},
    {248, "OpLabel", "r"},
    {249, "OpBranch", "i"},
    {250, "OpBranchConditional", "iiiL"},
    {251, "OpSwitch", "iiL"},
    {252, "OpKill", ""},
    {253, "OpReturn", ""},
    {254, "OpReturnValue", "i"},
    {255, "OpUnreachable", ""},
    {400, "OpCopyLogical", "tri"},
};

static const char *const extended[] = {
    [1] = "Round",      [2] = "RoundEven",     [3] = "Trunc",
    [4] = "FAbs",       [5] = "SAbs",          [6] = "FSign",
    [7] = "SSign",      [8] = "Floor",         [9] = "Ceil",
    [10] = "Fract",     [26] = "Pow",          [27] = "Exp",
    [28] = "Log",       [29] = "Exp2",         [30] = "Log2",
    [31] = "Sqrt",      [32] = "InverseSqrt",  [37] = "FMin",
    [38] = "UMin",      [39] = "SMin",         [40] = "FMax",
    [41] = "UMax",      [42] = "SMax",         [43] = "FClamp",
    [44] = "UClamp",    [45] = "SClamp",       [46] = "FMix",
    [48] = "Step",      [50] = "Fma",          [51] = "Frexp",
    [53] = "Ldexp",     [58] = "PackHalf2x16", [62] = "UnpackHalf2x16",
    [66] = "Length",    [67] = "Distance",     [68] = "Cross",
    [69] = "Normalize", [73] = "FindILsb",     [74] = "FindSMsb",
    [75] = "FindUMsb",  [79] = "NMin",         [80] = "NMax",
    [81] = "NClamp"};

static int by_number(const void *a, const void *b)
{
    return (int)*(const uint16_t *)a - (int)((const struct opcode *)b)->number;
}

static const struct opcode *opcode_of(const uint32_t *word)
{
    const uint16_t number = (uint16_t)(word[0] & 0xFFFFu);
    return bsearch(&number, opcodes, ARRAY_COUNT(opcodes), sizeof opcodes[0], by_number);
}

static const char *extended_name(uint32_t number)
{
    return number < ARRAY_COUNT(extended) ? extended[number] : NULL;
}

void spirv_say_name(const uint32_t *word, char text[SPIRV_SAY_MOST])
{
    const struct opcode *opcode = opcode_of(word);
    const bool is_extended = opcode && opcode->number == OP_EXT_INST && word[0] >> 16 > 4;
    const char *name = is_extended ? extended_name(word[4]) : opcode ? opcode->name : NULL;
    if (name)
        snprintf(text, SPIRV_SAY_MOST, "%s", name);
    else if (is_extended)
        snprintf(text, SPIRV_SAY_MOST, "extended instruction %u", word[4]);
    else
        snprintf(text, SPIRV_SAY_MOST, "Op%u", word[0] & 0xFFFFu);
}

/* The text of the words from word[at] on. */
static void say_string(const uint32_t *word, uint32_t at, char text[SPIRV_SAY_MOST])
{
    const size_t most = 4 * (size_t)((word[0] >> 16) - at);
    text_append(text, SPIRV_SAY_MOST, " \"%.*s\"", (int)most, (const char *)(word + at));
}

static void say_operand(const uint32_t *word, uint32_t at, char kind, char text[SPIRV_SAY_MOST])
{
    if (kind == 'x' && extended_name(word[at]))
        text_append(text, SPIRV_SAY_MOST, " %s", extended_name(word[at]));
    else if (kind == 'd' && word[at] == NO_CONTRACTION)
        text_append(text, SPIRV_SAY_MOST, " NoContraction");
    else
        text_append(text, SPIRV_SAY_MOST,
                    kind == 't' || kind == 'i' || kind == 'I' ? " %%%u" : " %u", word[at]);
}

void spirv_say(const uint32_t *word, char text[SPIRV_SAY_MOST])
{
    const struct opcode *opcode = opcode_of(word);
    const uint32_t count = word[0] >> 16;
    const char *kind = opcode ? opcode->operands : "L";
    const char *result = strchr(kind, 'r');
    char name[SPIRV_SAY_MOST];
    text[0] = '\0';
    spirv_say_name(word, name);
    if (result && (uint32_t)(result - kind) + 1 < count)
        text_append(text, SPIRV_SAY_MOST, "%%%u = ", word[1 + (result - kind)]);
    text_append(text, SPIRV_SAY_MOST, "%s", opcode ? opcode->name : name);
    for (uint32_t at = 1; at < count && *kind; at++) {
        if (*kind == 's') {
            say_string(word, at, text);
            break;
        }
        if (*kind != 'r')
            say_operand(word, at, *kind, text);
        kind += *kind != 'I' && *kind != 'L';
    }
}

uint32_t spirv_result(const uint32_t *word)
{
    const struct opcode *opcode = opcode_of(word);
    const char *at = opcode ? strchr(opcode->operands, 'r') : NULL;
    const uint32_t place = at ? (uint32_t)(at - opcode->operands) + 1 : 0;
    return at && place < word[0] >> 16 ? word[place] : 0;
}

uint32_t spirv_operands(const uint32_t *word)
{
    const struct opcode *opcode = opcode_of(word);
    const char *at = opcode ? strchr(opcode->operands, 'r') : NULL;
    return at ? (uint32_t)(at - opcode->operands) + 2 : 1;
}

size_t spirv_maker(const struct spirv_code *code, uint32_t id)
{
    size_t i = 0;
    while (i < code->count && (id == 0 || spirv_result(spirv_words(code, i)) != id))
        i++;
    return i;
}

/* The name of a function's id: without what its parameters are. */
static void say_function(const struct spirv_code *code, uint32_t id, char text[SPIRV_SAY_MOST])
{
    snprintf(text, SPIRV_SAY_MOST, "%%%u", id);
    for (size_t i = 0; i < code->count; i++) {
        const uint32_t *word = spirv_words(code, i);
        const size_t bytes = 4 * (spirv_length(code, i) - 2);
        if (spirv_op(code, i) != OP_NAME || spirv_length(code, i) < 3 || word[1] != id)
            continue;
        const char *name = (const char *)(word + 2), *end = memchr(name, '(', bytes);
        snprintf(text, SPIRV_SAY_MOST, "%.*s", (int)(end ? (size_t)(end - name) : bytes), name);
    }
}

void spirv_function(const struct spirv_code *code, size_t i, char text[SPIRV_SAY_MOST])
{
    text[0] = '\0';
    size_t k = i + 1; /* nothing stands behind the functions */
    while (k > 0 && spirv_op(code, k - 1) != OP_FUNCTION)
        k--;
    if (k > 0)
        say_function(code, spirv_words(code, k - 1)[2], text);
}
