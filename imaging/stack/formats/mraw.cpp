// Photron .mraw: frames without any header. A text file of the same name describes them: .cih ("key : value")
// or .cihx (XML). Layout: Photron, PFV manual; ladisk/pyMRAW pyMRAW.py.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "imaging/stack/formats/raw_stack.hpp"
#include "imaging/stack/formats/reader.hpp"

namespace twincell::imaging::frames {

namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blank);
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// Text between <tag ...> and </tag>; empty if there is no such element.
std::string_view element(std::string_view xml, const std::string& tag) {
  for (std::size_t at = xml.find("<" + tag); at != std::string_view::npos; at = xml.find("<" + tag, at + 1)) {
    const std::size_t after = at + 1 + tag.size();
    if (after >= xml.size() || (xml[after] != '>' && xml[after] != ' ')) continue;
    const std::size_t from = xml.find('>', after);
    if (from == std::string_view::npos) return {};
    const std::size_t end = xml.find("</" + tag + ">", from);
    return end == std::string_view::npos ? std::string_view{} : xml.substr(from + 1, end - from - 1);
  }
  return {};
}

/// The text file that describes the frames.
class CameraText {
 public:
  explicit CameraText(const fs::path& file) : file_(file) {
    const ByteFile in(file);
    constexpr std::uint64_t most = 1U << 20;  // both kinds are a few kB long
    if (in.size() > most) in.refuse(fmt::format("is not a Photron header: it has {} bytes.", in.size()));
    const auto bytes = in.bytes(0, in.size(), "the header");
    text_.assign(bytes.begin(), bytes.end());
    xml_ = element(text_, "cih");
    if (xml_.empty() && text_.find(':') == std::string::npos)
      in.refuse("is not a Photron header: it contains neither lines \"key : value\" nor an element <cih>.");
  }

  /// Value by its key in a .cih, or by its path of elements in a .cihx; empty if absent.
  [[nodiscard]] std::string text(std::string_view key, const std::vector<std::string>& path) const {
    if (!xml_.empty()) {
      std::string_view part = xml_;
      for (const std::string& tag : path) part = element(part, tag);
      return std::string(trimmed(part));
    }
    for (std::size_t at = 0; at < text_.size();) {
      const std::size_t end = std::min(text_.find('\n', at), text_.size());
      const std::string_view line = std::string_view(text_).substr(at, end - at);
      const std::size_t colon = line.find(':');
      if (colon != std::string_view::npos && trimmed(line.substr(0, colon)) == key)
        return std::string(trimmed(line.substr(colon + 1)));
      at = end + 1;
    }
    return {};
  }
  /// A number, or a quotient such as 1/2000.
  [[nodiscard]] std::optional<double> number(std::string_view key,
                                             const std::vector<std::string>& path) const {
    const std::string value = text(key, path);
    const std::size_t slash = value.find('/');
    const auto plain = [](std::string_view t) -> std::optional<double> {
      double x = 0;
      const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), x);
      return error == std::errc{} && std::isfinite(x) ? std::optional(x) : std::nullopt;
    };
    const auto above = plain(trimmed(std::string_view(value).substr(0, slash)));
    if (slash == std::string::npos || !above) return above;
    const auto below = plain(trimmed(std::string_view(value).substr(slash + 1)));
    return below && *below != 0 ? std::optional(*above / *below) : std::nullopt;
  }
  /// An integer. \throws InputError naming the key if it is absent or not an integer in 0 .. 2^32 - 1
  [[nodiscard]] std::uint64_t count(std::string_view key, const std::vector<std::string>& path) const {
    const auto value = number(key, path);
    if (!value)
      refuse(file_, fmt::format("is not a complete Photron header: \"{}\" is missing or not a number.",
                                xml_.empty() ? std::string(key) : fmt::format("{}", fmt::join(path, "/"))));
    if (*value < 0 || *value > UINT32_MAX || *value != std::floor(*value))
      refuse(file_, fmt::format("states {} = {}; a non-negative whole number is expected.", key, *value));
    return static_cast<std::uint64_t>(*value);
  }

 private:
  fs::path file_;
  std::string text_;
  std::string_view xml_;
};

class Mraw final : public RawStack {
 public:
  Mraw(const fs::path& planes, const fs::path& header) : RawStack(planes) {
    const CameraText text(header);
    const std::string kind = text.text("File Format", {"imageFileInfo", "fileFormat"});
    if (lower(kind) != "mraw")
      refuse(header,
             fmt::format("states that its frames are of format {}, not MRaw; name the pictures themselves.",
                         in_quotes(kind)));
    if (const std::string colour = lower(text.text("Color Type", {"imageDataInfo", "colorInfo", "type"}));
        colour == "color" || colour == "bayer")
      refuse(header, "states that its frames have colours; only grey .mraw files can be read.");
    const auto bits = text.count("Color Bit", {"imageDataInfo", "colorInfo", "bit"});
    const auto depth = text.count("EffectiveBit Depth", {"imageDataInfo", "effectiveBit", "depth"});
    const bool high =
        lower(text.text("EffectiveBit Side", {"imageDataInfo", "effectiveBit", "side"})) == "higher";
    if (bits != 8 && bits != 10 && bits != 12 && bits != 16)
      refuse(header, fmt::format("states Color Bit = {}; 8, 10, 12 or 16 can be read.", bits));
    if (high && (bits == 10 || bits == 12))
      refuse(header, fmt::format("states EffectiveBit Side = Higher for packed {}-bit values, on whose order "
                                 "of bits known readers disagree; save them as 16 bit.",
                                 bits));
    frames_ = text.count("Total Frame", {"frameInfo", "totalFrame"});
    set_layout(text.count("Image Width", {"imageDataInfo", "resolution", "width"}),
               text.count("Image Height", {"imageDataInfo", "resolution", "height"}), static_cast<int>(bits));
    info_.bits = static_cast<int>(depth >= 1 && depth <= bits ? depth : bits);
    if (high && bits == 16) layout_.shift = 16 - *info_.bits;
    info_.format = fmt::format("Photron mraw, {} bit", bits);
    if (const auto rate = text.number("Record Rate(fps)", {"recordInfo", "recordRate"}); rate && *rate > 0)
      info_.frame_rate_hz = rate;
    if (const auto shutter = text.number("Shutter Speed(s)", {"recordInfo", "shutterSpeed"});
        shutter && *shutter > 0)
      info_.exposure_s = shutter;
    if (const auto first = text.number("Start Frame", {"frameInfo", "startFrame"});
        first && std::abs(*first) < 1e15)
      info_.first_number = static_cast<std::int64_t>(*first);
    require_frames();
    require_last(place(frames_ - 1));
  }

 private:
  [[nodiscard]] std::uint64_t place(std::uint64_t i) const override { return i * layout_.bytes(); }
};

/// The file in the same folder that has the name of `file` and one of the extensions, in upper or lower case.
std::optional<fs::path> beside(const fs::path& file, const std::vector<std::string>& extensions) {
  std::error_code error;
  for (const std::string& wanted : extensions)
    for (const auto& entry : fs::directory_iterator(file.has_parent_path() ? file.parent_path() : ".", error))
      if (entry.path().stem() == file.stem() && lower(entry.path().extension().string()) == wanted)
        return entry.path();
  return {};
}

}  // namespace

extern const Reader mraw_reader;
const Reader mraw_reader = {
    .extensions = ".mraw .cih .cihx",
    // The files have no signature: the name decides.
    .owns =
        [](const Head& head) {
          return head.extension == ".mraw" || head.extension == ".cih" || head.extension == ".cihx";
        },
    .open = [](const fs::path& file, const std::string&) -> std::unique_ptr<FrameSource> {
      const bool planes = lower(file.extension().string()) == ".mraw";
      const auto other = planes ? beside(file, {".cihx", ".cih"}) : beside(file, {".mraw"});
      if (!other)
        refuse(file, fmt::format("lacks the file {} in the same folder, which contains its {}.",
                                 file.stem().string() + (planes ? ".cih or .cihx" : ".mraw"),
                                 planes ? "width, height and depth" : "frames"));
      return std::make_unique<Mraw>(planes ? file : *other, planes ? *other : file);
    }};

}  // namespace twincell::imaging::frames
