#pragma once
/// \file
/// Texts in a configuration that stand for values still to be filled in.

namespace twincell {

/// Beginning of a placeholder, such as "FILL IN: bead diameter in mm". Every query of such a key
/// (ConfigSection) throws a ConfigError that names the key and contains the rest of the text.
inline constexpr const char* kPlaceholder = "FILL IN: ";

}  // namespace twincell
