// The instruction set that vector kernels run on. Results differ by round-off from one set to another.
#pragma once

#include <string>
#include <vector>

namespace pivnp {

/// Those that the kernels are compiled for and this processor has, the best one first: avx3 (AVX-512), avx2, sse2.
std::vector<std::string> instruction_sets();
/// The one in use: the best one, unless another was chosen.
std::string instruction_set();
/// All kernels run on this one from here on; empty: on the best one. Throws InputError, which begins with `key`, where
/// there is none of that name or this processor lacks it.
void use_instruction_set(const std::string& name, const std::string& key);

}  // namespace pivnp
