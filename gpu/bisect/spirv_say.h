/* SPIR-V for people: names of instructions, a line of an instruction, the function that it stands
 * in. Ids are numbers, as they stand in the module. */
#ifndef SPIRV_SAY_H
#define SPIRV_SAY_H

#include "gpu/bisect/spirv_diff.h"
#include "gpu/shaders/spirv_words.h"

#define SPIRV_SAY_MOST 160u

/* "OpFMul"; of an extended instruction of GLSL.std.450 its name there, "Fma"; "Op4421" of an opcode
 * that is not in the table here. */
void spirv_say_name(const uint32_t *word, char text[SPIRV_SAY_MOST]);

/* "%12 = OpFMul %6 %10 %11", as a disassembler has it; cut to what fits. */
void spirv_say(const uint32_t *word, char text[SPIRV_SAY_MOST]);

/* The id that an instruction makes, 0 if it makes none or is not in the table; the first word of
 * its operands behind that. */
uint32_t spirv_result(const uint32_t *word);
uint32_t spirv_operands(const uint32_t *word);

/* The instruction that makes an id; code->count if there is none. */
size_t spirv_maker(const struct spirv_code *code, uint32_t id);

/* Writes the name of the function in which instruction i stands, as its source has it, "%12" if the
 * module has no name for it, and "" outside of functions. */
void spirv_function(const struct spirv_code *code, size_t i, char text[SPIRV_SAY_MOST]);

#endif
