/* Numbers of SPIR-V (its specification, "Binary Form"): the header, opcodes, decorations and
 * storage classes that are looked at somewhere. An instruction's first word is its length in words,
 * shifted by 16, and its opcode. */
#ifndef SPIRV_WORDS_H
#define SPIRV_WORDS_H

#define SPIRV_MAGIC        0x07230203u
#define SPIRV_HEADER_WORDS 5u
#define SPIRV_BOUND_MOST   0x3FFFFFu /* the specification's limit of ids */

enum spirv_opcode {
    OP_SOURCE_CONTINUED = 2,
    OP_NAME = 5,
    OP_LINE = 8,
    OP_EXTENSION = 10,
    OP_EXT_INST_IMPORT = 11,
    OP_EXT_INST = 12,
    OP_MEMORY_MODEL = 14,
    OP_ENTRY_POINT = 15,
    OP_EXECUTION_MODE = 16,
    OP_CAPABILITY = 17,
    OP_TYPE_VOID = 19, /* the first of types */
    OP_TYPE_INT = 21,
    OP_TYPE_FLOAT = 22,
    OP_TYPE_VECTOR = 23,
    OP_TYPE_MATRIX = 24,
    OP_TYPE_IMAGE = 25,
    OP_TYPE_RUNTIME_ARRAY = 29,
    OP_TYPE_STRUCT = 30,
    OP_TYPE_POINTER = 32,
    OP_CONSTANT = 43,
    OP_SPEC_CONSTANT_OP = 52,
    OP_FUNCTION = 54,
    OP_FUNCTION_END = 56,
    OP_FUNCTION_CALL = 57,
    OP_VARIABLE = 59,
    OP_LOAD = 61,
    OP_STORE = 62,
    OP_COPY_MEMORY = 63,
    OP_ACCESS_CHAIN = 65,
    OP_IN_BOUNDS_ACCESS_CHAIN = 66,
    OP_ARRAY_LENGTH = 68,
    OP_DECORATE = 71,
    OP_MEMBER_DECORATE = 72,
    OP_EXTRACT_DYNAMIC = 77,
    OP_COMPOSITE_EXTRACT = 81,
    OP_COPY_OBJECT = 83,
    OP_IMAGE_FETCH = 95,
    OP_BITCAST = 124,
    OP_FNEGATE = 127,
    OP_OUTER_PRODUCT = 147,
    OP_SELECT = 169,
    OP_ATOMIC_FIRST = 227,
    OP_ATOMIC_LAST = 242,
    OP_PHI = 245,
    OP_NO_LINE = 317,
    OP_MODULE_PROCESSED = 330,
    OP_EXECUTION_MODE_ID = 331
};

enum spirv_decoration {
    DECORATION_SPEC_ID = 1,
    DECORATION_BLOCK = 2,
    DECORATION_BINDING = 33,
    DECORATION_DESCRIPTOR_SET = 34,
    DECORATION_OFFSET = 35,
    NO_CONTRACTION = 42
};

enum spirv_class { CLASS_UNIFORM_CONSTANT = 0, CLASS_STORAGE_BUFFER = 12, CLASS_PHYSICAL = 5349 };

#endif
