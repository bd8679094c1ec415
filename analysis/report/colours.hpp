#pragma once
/// \file
/// Colours of all figures, from the palette of Okabe and Ito, which readers with any colour vision can
/// distinguish. Every colour is also paired with its own symbol shape.

#include <array>
#include <string>
#include <utility>

namespace twincell::analysis::colours {

inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kOrange = "#E69F00";
inline constexpr const char* kVermilion = "#D55E00";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kSky = "#56B4E9";
inline constexpr const char* kPurple = "#CC79A7";
inline constexpr const char* kBlack = "#000000";
inline constexpr const char* kGrey = "#9A9A9A";
inline constexpr const char* kSand = "#E8E0C8";
inline constexpr const char* kPale = "#EEEEEE";
inline constexpr const char* kWhite = "#FFFFFF";

/// Colours of successive curves.
inline constexpr std::array<const char*, 7> kCurves = {kBlue,   kVermilion, kGreen, kPurple,
                                                       kOrange, kSky,       kBlack};

/// The palette as gnuplot variables for the head of every script, for use as in `lc rgb blue`.
inline std::string for_gnuplot() {
  std::string text;
  for (const auto& [name, colour] :
       {std::pair{"blue", kBlue}, std::pair{"orange", kOrange}, std::pair{"vermilion", kVermilion},
        std::pair{"green", kGreen}, std::pair{"sky", kSky}, std::pair{"purple", kPurple},
        std::pair{"grey", kGrey}})
    text += std::string(name) + " = '" + colour + "'\n";
  return text;
}

}  // namespace twincell::analysis::colours
