// Single pictures: PNG, JPEG, BMP, PGM. A decoder returns the readable top of a damaged picture without an
// error. Each file is therefore checked first: it must be complete, its size in pixels must be plausible for
// its size in bytes, and checksums must match where the format has them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <boost/crc.hpp>
#include <cctype>
#include <utility>

#include "core/picture_names.hpp"
#include "imaging/codecs/codecs.hpp"
#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/raw_pixels.hpp"
#include "imaging/stack/formats/reader.hpp"

namespace twincell::imaging::frames {

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

std::uint32_t crc32(const std::uint8_t* data, std::size_t n) {
  boost::crc_32_type sum;
  sum.process_bytes(data, n);
  return sum.checksum();
}

void require_size(const fs::path& file, const Bytes& b, std::uint64_t width, std::uint64_t height) {
  require_plausible_size(file, width, height, 8, b.size());  // four channels of 16 bits
}

void check_png(const fs::path& file, const Bytes& b) {
  if (b.size() >= 24) require_size(file, b, number_at(&b[16], 4, true), number_at(&b[20], 4, true));
  for (std::size_t at = 8; at + 12 <= b.size();) {
    const std::size_t length = number_at(&b[at], 4, true);
    if (length > b.size() - at - 12) break;
    if (crc32(&b[at + 4], length + 4) != number_at(&b[at + 8 + length], 4, true))
      refuse(file, fmt::format("is damaged: the PNG chunk at byte {} fails its checksum.", at));
    if (std::equal(&b[at + 4], &b[at + 8], "IEND")) return;
    at += 12 + length;
  }
  refuse(file, fmt::format("is truncated: the PNG picture does not end within its {} bytes.", b.size()));
}

void check_jpeg(const fs::path& file, const Bytes& b) {
  std::size_t end = b.size();
  while (end > 2 && b[end - 1] == 0) --end;  // some cameras pad with zeros
  if (b[end - 2] != 0xFF || b[end - 1] != 0xD9)
    refuse(file, fmt::format("is truncated: the JPEG picture does not end within its {} bytes.", b.size()));
  for (std::size_t at = 2; at + 9 <= b.size() && b[at] == 0xFF;) {
    const std::uint8_t kind = b[at + 1];
    const bool frame = kind >= 0xC0 && kind <= 0xCF && kind != 0xC4 && kind != 0xC8 && kind != 0xCC;
    if (frame) return require_size(file, b, number_at(&b[at + 7], 2, true), number_at(&b[at + 5], 2, true));
    at += 2 + number_at(&b[at + 2], 2, true);
  }
}

void check_bmp(const fs::path& file, const Bytes& b) {
  if (b.size() < 26 || number_at(&b[2], 4, false) > b.size())
    refuse(file, fmt::format("is truncated: the BMP picture does not end within its {} bytes.", b.size()));
  const auto side = [&](std::size_t at) {
    const auto n = static_cast<std::int32_t>(number_at(&b[at], 4, false));
    return static_cast<std::uint64_t>(n < 0 ? -std::int64_t{n} : n);  // negative: top row first
  };
  require_size(file, b, side(18), side(22));
}

// Checks "P5 width height largest" and the pixels; comments begin with '#'. \returns the largest value
std::uint64_t check_pgm(const fs::path& file, const Bytes& b) {
  std::size_t at = 2;
  const auto number = [&]() -> std::uint64_t {
    while (at < b.size() && (std::isspace(b[at]) != 0 || b[at] == '#'))
      if (b[at++] == '#')
        while (at < b.size() && b[at] != '\n') ++at;
    std::uint64_t n = 0;
    const std::size_t first = at;
    for (; at < b.size() && std::isdigit(b[at]) != 0 && at - first < 10; ++at) n = 10 * n + (b[at] - '0');
    if (at == first) refuse(file, "is damaged: the PGM header lacks a number.");
    return n;
  };
  const std::uint64_t width = number(), height = number(), largest = number();
  require_size(file, b, width, height);
  const std::uint64_t needed = width * height * (largest > 255 ? 2 : 1);
  if (b[1] == '5' && (at + 1 > b.size() || b.size() - at - 1 < needed))
    refuse(file, fmt::format("is truncated: the PGM picture does not end within its {} bytes.", b.size()));
  return largest;
}

/// Orientation in an EXIF block, which is a small TIFF file; 1 if it states none.
std::uint64_t orientation_in_exif(const std::uint8_t* b, std::size_t n) {
  constexpr std::uint64_t kOrientation = 274, kShort = 3;
  if (n < 14 || !(b[0] == b[1] && (b[0] == 'I' || b[0] == 'M'))) return 1;
  const bool big_first = b[0] == 'M';
  const std::uint64_t at = number_at(b + 4, 4, big_first);
  if (at > n - 2) return 1;
  const std::uint64_t entries = number_at(b + at, 2, big_first);
  for (std::uint64_t i = 0; i < entries; ++i) {
    const std::uint64_t entry = at + 2 + 12 * i;
    if (entry + 12 > n) return 1;
    if (number_at(b + entry, 2, big_first) == kOrientation)
      return number_at(b + entry + 2, 2, big_first) == kShort ? number_at(b + entry + 8, 2, big_first) : 1;
  }
  return 1;
}

/// Orientation in the EXIF block of a JPEG picture; 1 if it states none.
std::uint64_t orientation_of_jpeg(const Bytes& b) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  for (std::size_t at = 2; at + 4 <= b.size() && b[at] == 0xFF && b[at + 1] != 0xDA;) {
    const std::size_t length = number_at(&b[at + 2], 2, true);
    if (b[at + 1] == 0xE1 && length >= 2 + kExif.size() && at + 2 + length <= b.size() &&
        std::equal(kExif.begin(), kExif.end(), &b[at + 4],
                   [](char c, std::uint8_t byte) { return static_cast<std::uint8_t>(c) == byte; }))
      return orientation_in_exif(&b[at + 4 + kExif.size()], length - 2 - kExif.size());
    at += 2 + length;
  }
  return 1;
}

/// What the chunks of a PNG state beside the picture.
struct PngExtras {
  std::uint64_t orientation = 1;  ///< chunk eXIf
  std::uint64_t frames = 1;       ///< of an animation, chunk acTL
};
PngExtras extras_of_png(const Bytes& b) {
  PngExtras extras;
  for (std::size_t at = 8; at + 12 <= b.size();) {
    const std::size_t length = number_at(&b[at], 4, true);
    if (length > b.size() - at - 12) break;
    const std::string_view kind(reinterpret_cast<const char*>(&b[at + 4]), 4);
    if (kind == "eXIf") extras.orientation = orientation_in_exif(&b[at + 8], length);
    if (kind == "acTL" && length >= 4) extras.frames = number_at(&b[at + 8], 4, true);
    at += 12 + length;
  }
  return extras;
}

struct Kind {
  std::string_view name, magic;
};
constexpr std::array<Kind, 5> kKinds = {{{"PNG", "\x89PNG\r\n\x1a\n"},
                                         {"JPEG", "\xff\xd8\xff"},
                                         {"BMP", "BM"},
                                         {"PGM", "P5"},
                                         {"PGM", "P2"}}};  // P2: in decimal digits

const Kind* kind_of(const Head& head) {
  for (const Kind& kind : kKinds)
    if (head.starts_with(kind.magic)) return &kind;
  return nullptr;
}

class Picture final : public FrameSource {
 public:
  explicit Picture(const fs::path& file) : file_(file) {
    const ByteFile in(file);
    const std::string_view kind = kind_of(head_of(file))->name;
    const Bytes bytes = in.bytes(0, in.size(), "the picture");
    PngExtras extras;
    if (kind == "PNG") {
      check_png(file, bytes);
      extras = extras_of_png(bytes);
    }
    if (kind == "JPEG") {
      check_jpeg(file, bytes);
      extras.orientation = orientation_of_jpeg(bytes);
    }
    if (kind == "BMP") check_bmp(file, bytes);
    if (kind == "PGM") info_.bits = std::bit_width(check_pgm(file, bytes));
    cv::Mat picture;
    try {
      picture = codecs().decode(bytes);
    } catch (const cv::Exception&) {  // reported below
    }
    if (picture.empty()) in.refuse(fmt::format("cannot be decoded as a {} picture.", kind));
    frame_ = oriented(grey(picture, file), extras.orientation);
    if (std::string note = orientation_note(extras.orientation); !note.empty())
      info_.notes.push_back(std::move(note));
    if (extras.frames > 1)
      info_.notes.push_back(fmt::format(
          "the animated PNG has {} frames, of which the first is read; save the frames as single files.",
          extras.frames));
    info_.format = fmt::format("{} picture, {} bit", kind, 8 * picture.elemSize1());
    info_.width = frame_.cols;
    info_.height = frame_.rows;
  }

  bool next(cv::Mat& frame) override {
    if (frame_.empty()) return false;
    frame = std::exchange(frame_, cv::Mat());
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return 1; }
  [[nodiscard]] std::string current() const override { return file_.string(); }
  [[nodiscard]] StackInfo info() const override { return info_; }

 private:
  fs::path file_;
  cv::Mat frame_;
  StackInfo info_;
};

}  // namespace

extern const Reader picture_reader;
const Reader picture_reader = {
    .extensions = kPictureEndings,
    .owns = [](const Head& head) { return kind_of(head) != nullptr; },
    .open = [](const fs::path& file, const std::string&) -> std::unique_ptr<FrameSource> {
      return std::make_unique<Picture>(file);
    }};

}  // namespace twincell::imaging::frames
