#pragma once
/// \file
/// Colours of all figures, of Okabe and Ito's palette: told apart by readers with any colour vision. Every
/// colour has a shape of its own as well.

namespace twincell::colours {

inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kOrange = "#E69F00";
inline constexpr const char* kVermilion = "#D55E00";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kSky = "#56B4E9";
inline constexpr const char* kGrey = "#9A9A9A";
inline constexpr const char* kSand = "#E8E0C8";
inline constexpr const char* kPale = "#EEEEEE";
inline constexpr const char* kWhite = "#FFFFFF";

}  // namespace twincell::colours
