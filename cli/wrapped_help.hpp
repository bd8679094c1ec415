#pragma once
/// \file
/// The layout of --help: lines of at most 100 columns.

#include <memory>

namespace CLI {
class FormatterBase;
}

namespace twincell::cli {

/// CLI11's help with descriptions that wrap between words.
std::shared_ptr<CLI::FormatterBase> wrapped_help();

}  // namespace twincell::cli
