# SPIR-V of every shaders/*.comp, and its embedding into C.
