#pragma once
/// \file
/// The nearest known word, for "did you mean".

#include <string>
#include <vector>

namespace twincell {

/// The word of `known` with the smallest Levenshtein distance from `word`, the first of several; empty
/// if that distance is above 3 or above half of the letters and digits of `word`.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace twincell
