#pragma once
/// \file
/// Text for a terminal of a given width.

#include <cstddef>
#include <string>

namespace twincell {

/// Number of columns of a line in UTF-8, without combining characters.
std::size_t columns_of(const std::string& line);

/// Breaks a line at spaces, so that no part has more than `width` columns unless a single word has; `later`
/// is the beginning of every part but the first. Ends with a newline.
std::string fold_line(const std::string& line, std::size_t width, const std::string& later);

/// Folds the lines of a text. The continuation of a line begins below its last column, or, if that is in the
/// right half or the line has no columns, four columns right of its beginning.
std::string fit_columns(const std::string& text, std::size_t width);

}  // namespace twincell
