#include "core/choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.hpp"

namespace twincell {

void refuse_word(const std::string& key, const std::string& noun, const std::string& word,
                 const std::vector<std::string>& words) {
  throw ConfigError({.file = {}, .key = key},
                    fmt::format("there is no {} '{}'; there are: {}.", noun, word, fmt::join(words, ", ")));
}

}  // namespace twincell
