// TIFF and BigTIFF, read page by page with libtiff. Also the stacks above 4 GB that ImageJ writes as one page
// followed by planes without page headers.

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "core/picture_names.hpp"
#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/raw_stack.hpp"
#include "imaging/stack/formats/reader.hpp"
#include "imaging/stack/formats/size_guard.hpp"

namespace twincell::imaging::frames {

namespace {

namespace fs = std::filesystem;

/// Result of the walk along the pages: their number, and properties of the first page.
struct Walked {
  std::size_t pages = 0;
  bool big_first = false;
  std::uint64_t width = 0, height = 0, bits = 1, samples = 1, compression = 1, photometric = 1;
  std::uint64_t first_strip = 0;
  std::string description;
};

/// Walks along the directories (one per page) without reading pixels. Each page must be inside the file, and
/// its size must be plausible for the file size. libtiff does not check this: it stops at the first invalid
/// link, so that a truncated stack looks like a shorter one, and it does not validate sizes.
class Walk {
 public:
  explicit Walk(const ByteFile& in) : in_(in) {}

  Walked run() {
    const std::vector<std::uint8_t> head = in_.bytes(0, 8, kPage);
    found_.big_first = big_first_ = head[0] == 'M';
    wide_ = number_at(&head[2], 2, big_first_) == 43;
    std::uint64_t at = wide_ ? number(8, 8) : number(4, 4);
    for (; at != 0; ++found_.pages) {
      // A chain of more pages than the file has room for is circular.
      if (found_.pages > in_.size() / 8) in_.refuse("is damaged: its chain of pages has no end.");
      at = page(at);
    }
    if (found_.pages == 0) in_.refuse("is a TIFF file without pages.");
    return found_;
  }

 private:
  /// Size and storage of one page. A piece is a strip, as wide as the page, or a tile.
  struct Page {
    Walked properties;
    std::vector<std::uint64_t> offsets, lengths;      // of the pieces, bytes
    std::uint64_t piece_width = 0, piece_height = 0;  // px; 0: as the page
  };

  // Checks the page at `at`; returns the position of the next one.
  std::uint64_t page(std::uint64_t at) {
    const std::uint64_t count_bytes = wide_ ? 8 : 2, entry_bytes = wide_ ? 20 : 12, word = wide_ ? 8 : 4;
    const std::uint64_t n = number(at, count_bytes);
    if (n > in_.size() / entry_bytes) in_.require(in_.size(), entry_bytes, kPage);
    entries_ = in_.bytes(at + count_bytes, n * entry_bytes + word, kPage);
    Page page;
    for (std::uint64_t i = 0; i < n; ++i) read_entry(&entries_[i * entry_bytes], page);
    require_size(page.properties);
    require_pieces(page);
    require_lengths(page);
    if (found_.pages == 0) keep_as_first(page);
    return number_at(&entries_[n * entry_bytes], word, big_first_);
  }

  // Reads one of the tags that determine size and storage of the page; ignores the others.
  void read_entry(const std::uint8_t* entry, Page& page) {
    Walked& properties = page.properties;
    switch (number_at(entry, 2, big_first_)) {
      case 256:
        properties.width = first(entry);
        break;
      case 257:
        properties.height = first(entry);
        break;
      case 258:
        properties.bits = first(entry);
        break;
      case 259:
        properties.compression = first(entry);
        break;
      case 262:
        properties.photometric = first(entry);
        break;
      case 277:
        properties.samples = first(entry);
        break;
      case 270:
        if (found_.pages == 0) found_.description = text(entry);
        break;
      case 278:
      case 323:
        page.piece_height = first(entry);
        break;
      case 322:
        page.piece_width = first(entry);
        break;
      case 273:
      case 324:
        page.offsets = values(entry);
        break;  // offsets of strips or tiles
      case 279:
      case 325:
        page.lengths = values(entry);
        break;
      default:
        break;
    }
  }

  // The size must be plausible before memory is allocated.
  void require_size(const Walked& page) const {
    if (page.samples == 0 || page.samples > 64 || page.bits == 0 || page.bits > 64)
      in_.refuse(fmt::format("states that page {} has {} samples of {} bits per pixel.", found_.pages + 1,
                             page.samples, page.bits));
    require_plausible_size(in_.path(), page.width, page.height,
                           std::max<std::uint64_t>(4, page.samples * ((page.bits + 7) / 8)), in_.size());
  }

  // All strips or tiles must be present, since libtiff fills in missing ones without an error.
  void require_pieces(const Page& page) const {
    const auto pieces = [](std::uint64_t side, std::uint64_t piece) {
      return piece == 0 ? 1 : (side + piece - 1) / piece;
    };
    const std::uint64_t wanted =
        pieces(page.properties.width, page.piece_width) * pieces(page.properties.height, page.piece_height);
    if (page.offsets.size() < wanted)
      in_.refuse(fmt::format(
          "is truncated or damaged: page {} consists of {} pieces, of which {} have a place in the file.",
          found_.pages + 1, wanted, page.offsets.size()));
  }

  // The pieces must be inside the file, and without compression they must contain all pixels.
  void require_lengths(const Page& page) const {
    const Walked& properties = page.properties;
    const std::uint64_t needed =
        (properties.width * properties.samples * properties.bits + 7) / 8 * properties.height;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < std::min(page.offsets.size(), page.lengths.size()); ++i) {
      in_.require(page.offsets[i], page.lengths[i], fmt::format("page {}", found_.pages + 1));
      sum += page.lengths[i];
    }
    constexpr std::uint64_t kNone = 1, kSubsampledColour = 6;
    if (properties.compression != kNone || properties.photometric == kSubsampledColour || sum >= needed)
      return;
    if (!page.lengths.empty())
      in_.refuse(fmt::format("is truncated or damaged: page {} has {} bytes of pixels, of the {} it needs.",
                             found_.pages + 1, sum, needed));
    in_.require(page.offsets[0], needed, fmt::format("page {}", found_.pages + 1));
  }

  void keep_as_first(const Page& page) {
    Walked properties = page.properties;
    properties.big_first = big_first_;
    properties.description = found_.description;
    properties.first_strip = page.offsets.empty() ? 0 : page.offsets[0];
    found_ = properties;
  }

  [[nodiscard]] std::uint64_t bytes_each(const std::uint8_t* entry) const {
    switch (number_at(entry + 2, 2, big_first_)) {
      case 1:
      case 2:
        return 1;  // BYTE, ASCII
      case 3:
        return 2;  // SHORT
      case 4:
        return 4;  // LONG
      case 16:
        return 8;  // LONG8
      default:
        return 0;
    }
  }
  // Data of an entry: in the entry itself if they fit, otherwise elsewhere in the file.
  [[nodiscard]] std::vector<std::uint8_t> data(const std::uint8_t* entry, std::uint64_t most) const {
    const std::uint64_t each = bytes_each(entry), word = wide_ ? 8 : 4;
    std::uint64_t n = number_at(entry + 4, word, big_first_);
    if (each == 0) return {};
    if (n > in_.size() / each && n * each > word) in_.require(in_.size(), n, kPage);
    n = std::min(n * each, most * each);
    const std::uint8_t* here = entry + 4 + word;
    if (number_at(entry + 4, word, big_first_) * each <= word) return {here, here + n};
    return in_.bytes(number_at(here, word, big_first_), n, kPage);
  }
  [[nodiscard]] std::vector<std::uint64_t> values(const std::uint8_t* entry,
                                                  std::uint64_t most = UINT32_MAX) const {
    const std::uint64_t each = bytes_each(entry);
    const std::vector<std::uint8_t> b = data(entry, most);
    std::vector<std::uint64_t> v;
    for (std::uint64_t i = 0; each > 0 && i + each <= b.size(); i += each)
      v.push_back(number_at(&b[i], each, big_first_));
    return v;
  }
  [[nodiscard]] std::uint64_t first(const std::uint8_t* entry) const {
    const auto v = values(entry, 1);
    return v.empty() ? 0 : v[0];
  }
  [[nodiscard]] std::string text(const std::uint8_t* entry) const {
    const auto b = data(entry, 65536);
    return {b.begin(), std::find(b.begin(), b.end(), 0)};
  }
  [[nodiscard]] std::uint64_t number(std::uint64_t at, std::uint64_t n) const {
    return in_.number(at, n, kPage, big_first_);
  }

  static constexpr const char* kPage = "a TIFF page";
  const ByteFile& in_;
  bool big_first_ = false, wide_ = false;
  std::vector<std::uint8_t> entries_;
  Walked found_;
};

/// Value of a line "key=..." in ImageJ's description.
std::optional<double> imagej(const std::string& description, const std::string& key) {
  if (!description.starts_with("ImageJ=")) return {};
  const std::size_t at = description.find("\n" + key + "=");
  if (at == std::string::npos) return {};
  const char* from = description.data() + at + key.size() + 2;
  double value = 0;
  const auto [end, error] = std::from_chars(from, description.data() + description.size(), value);
  return error == std::errc{} && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

StackInfo describe(const Walked& walked) {
  StackInfo info;
  info.format = fmt::format("TIFF, {} bit", walked.bits);
  info.width = static_cast<int>(walked.width);
  info.height = static_cast<int>(walked.height);
  // ImageJ's "finterval" is the time between frames; its "fps" is the speed of playing the stack.
  if (const auto step = imagej(walked.description, "finterval"); step && *step > 0) {
    info.frame_rate_hz = 1 / *step;
  } else if (const auto rate = imagej(walked.description, "fps"); rate && *rate > 0) {
    info.frame_rate_hz = rate;
    info.playback = true;
  }
  if (const auto channels = imagej(walked.description, "channels"); channels && *channels > 1)
    info.notes.push_back(fmt::format(
        "the ImageJ stack has {} channels, whose planes follow one another as frames.", *channels));
  return info;
}

/// An ImageJ stack of which only the first plane is a TIFF page. The others follow it without page headers.
class BarePlanes final : public RawStack {
 public:
  BarePlanes(const fs::path& file, const Walked& walked, double planes) : RawStack(file) {
    if (walked.compression != 1 || walked.samples != 1 || (walked.bits != 8 && walked.bits != 16))
      in_.refuse(fmt::format(
          "states that it contains {} ImageJ planes but has one page, and its planes of {} x {} bits, "
          "compression {}, cannot follow that page: save it as a stack of pages or as single files.",
          planes, walked.samples, walked.bits, walked.compression));
    if (planes > UINT32_MAX) in_.refuse(fmt::format("states that it contains {} planes.", planes));
    frames_ = static_cast<std::uint64_t>(planes);
    first_ = walked.first_strip;
    info_ = describe(walked);
    info_.bits = static_cast<int>(walked.bits);
    info_.format += " ImageJ stack on one page";
    set_layout(walked.width, walked.height, static_cast<int>(walked.bits));
    layout_.big_first = walked.big_first;
    require_frames();
    require_last(place(frames_ - 1));
  }

 private:
  [[nodiscard]] std::uint64_t place(std::uint64_t i) const override {
    in_.require(first_, (i + 1) * layout_.bytes(), fmt::format("plane {} of {}", i + 1, frames_));
    return first_ + i * layout_.bytes();
  }
  std::uint64_t first_ = 0;
};

class Pages final : public FrameSource {
 public:
  Pages(const fs::path& file, const Walked& walked)
      : file_(file), file_size_(fs::file_size(file)), pages_(walked.pages) {
    info_ = describe(walked);
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_complaint, this);
    TIFFOpenOptionsSetWarningHandlerExtR(
        options, [](TIFF*, void*, const char*, const char*, va_list) -> int { return 1; }, nullptr);
    tiff_.reset(TIFFOpenExt(file.c_str(), "rm", options));  // m: no memory mapping, since the file may shrink
    TIFFOpenOptionsFree(options);
    if (!tiff_) damaged("is not a readable TIFF file");
    read_bits();
    note_appearance();
  }

  bool next(cv::Mat& frame) override {
    if (read_ == pages_) return false;
    if (read_ > 0 && TIFFReadDirectory(tiff_.get()) != 1)
      damaged(fmt::format("has no readable page {}", read_ + 1));
    ++read_;
    complaint_.clear();
    frame = oriented(page(), field(TIFFTAG_ORIENTATION));
    guard_.check(frame, current());
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return pages_; }
  [[nodiscard]] std::string current() const override {
    return pages_ == 1 ? file_.string()
                       : fmt::format("{}, page {}", file_.string(), std::max<std::size_t>(read_, 1));
  }
  [[nodiscard]] StackInfo info() const override { return info_; }

 private:
  [[gnu::format(printf, 4, 0)]] static int keep_complaint(TIFF* /*tiff*/, void* self, const char* /*module*/,
                                                          const char* form, va_list words) {
    std::array<char, 400> text{};
    std::vsnprintf(text.data(), text.size(), form, words);
    static_cast<Pages*>(self)->complaint_ = text.data();
    return 1;
  }
  struct Close {
    void operator()(TIFF* t) const { TIFFClose(t); }
  };

  [[noreturn]] void damaged(const std::string& what) const {
    refuse(file_,
           fmt::format("{}: {}.", what,
                       complaint_.empty() ? "it is damaged" : "libtiff says " + in_quotes(complaint_)));
  }
  [[nodiscard]] std::uint64_t field(ttag_t tag) const {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(tiff_.get(), tag, &value);
    return value;
  }
  void read_bits() {
    if (!is_plain()) {
      info_.bits = 8;
      info_.notes.emplace_back("palette, separate planes or fewer than 8 bits: rendered as 8 bit.");
      return;
    }
    if (field(TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_IEEEFP || field(TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_INT)
      return;
    info_.bits = static_cast<int>(field(TIFFTAG_BITSPERSAMPLE));
    std::uint16_t largest = 0;  // set only if the file has the tag
    if (TIFFGetField(tiff_.get(), TIFFTAG_MAXSAMPLEVALUE, &largest) == 1 && largest > 0)
      info_.bits = std::min(*info_.bits, static_cast<int>(std::bit_width(std::uint32_t{largest})));
  }

  /// Notes that the frames are not the pixels as they are stored.
  void note_appearance() {
    const std::uint64_t orientation = field(TIFFTAG_ORIENTATION);
    if (orientation >= 5 && orientation <= 8) std::swap(info_.width, info_.height);
    if (std::string note = orientation_note(orientation); !note.empty())
      info_.notes.push_back(std::move(note));
    std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    TIFFGetField(tiff_.get(), TIFFTAG_PHOTOMETRIC, &photometric);
    if (photometric == PHOTOMETRIC_MINISWHITE)
      info_.notes.emplace_back(
          is_inverted()
              ? "zero is white in this file (WhiteIsZero): its values are inverted, as viewers show it."
              : "zero is white in this file (WhiteIsZero), but its values are signed or real numbers "
                "and are not inverted: bright and dark are exchanged.");
  }
  /// Whether the values of a page in which zero is white are inverted: their largest value is known.
  [[nodiscard]] bool is_inverted() const {
    return !is_plain() ||
           (field(TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_UINT && field(TIFFTAG_BITSPERSAMPLE) <= 16);
  }

  /// Whether the page stores the values that the camera measured, so that they can be read unchanged.
  [[nodiscard]] bool is_plain() const {
    const std::uint64_t bits = field(TIFFTAG_BITSPERSAMPLE), samples = field(TIFFTAG_SAMPLESPERPIXEL);
    const std::uint64_t format = field(TIFFTAG_SAMPLEFORMAT);
    std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    TIFFGetField(tiff_.get(), TIFFTAG_PHOTOMETRIC, &photometric);
    if (photometric == PHOTOMETRIC_RGB)
      return samples >= 3 && samples <= 4 && format == SAMPLEFORMAT_UINT && (bits == 8 || bits == 16) &&
             field(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_CONTIG;
    if (photometric > PHOTOMETRIC_MINISBLACK || samples != 1) return false;
    return format == SAMPLEFORMAT_IEEEFP ? bits == 32 || bits == 64
           : format == SAMPLEFORMAT_INT  ? bits == 8 || bits == 16 || bits == 32
                                         : (bits >= 8 && bits <= 16) || bits == 32;
  }
  [[nodiscard]] cv::Mat page() const {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff_.get(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff_.get(), TIFFTAG_IMAGELENGTH, &height);
    const std::uint64_t bits = field(TIFFTAG_BITSPERSAMPLE), samples = field(TIFFTAG_SAMPLESPERPIXEL);
    const std::uint64_t format = field(TIFFTAG_SAMPLEFORMAT);
    std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    TIFFGetField(tiff_.get(), TIFFTAG_PHOTOMETRIC, &photometric);
    const bool real = format == SAMPLEFORMAT_IEEEFP;
    require_plausible_size(file_, width, height, std::max<std::uint64_t>(4, samples * ((bits + 7) / 8)),
                           file_size_);
    if (!is_plain()) return by_rgba(width, height);

    const std::size_t row_bytes = (width * samples * bits + 7) / 8;
    const std::vector<std::uint8_t> raw = raw_rows(height, row_bytes, samples * bits);
    const auto channels = static_cast<int>(samples);
    const auto rows = static_cast<int>(height), columns = static_cast<int>(width);
    if (bits > 8 && bits < 16) {
      cv::Mat picture(rows, columns, CV_16U);
      for (int y = 0; y < rows; ++y)
        unpack_bits(&raw[static_cast<std::size_t>(y) * row_bytes], static_cast<int>(bits), width,
                    picture.ptr<std::uint16_t>(y));
      return upright(picture, photometric, bits);
    }
    const bool sign = format == SAMPLEFORMAT_INT;
    const int depth = real         ? (bits == 32 ? CV_32F : CV_64F)
                      : bits == 8  ? (sign ? CV_8S : CV_8U)
                      : bits == 16 ? (sign ? CV_16S : CV_16U)
                                   : CV_32S;
    cv::Mat picture(rows, columns, CV_MAKETYPE(depth, channels));
    std::memcpy(picture.data, raw.data(), std::min(raw.size(), picture.total() * picture.elemSize()));
    if (depth == CV_32S && !sign) {  // OpenCV has no unsigned 32-bit type
      cv::Mat real_picture(rows, columns, CV_32F);
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
          real_picture.at<float>(y, x) =
              static_cast<float>(static_cast<std::uint32_t>(picture.at<std::int32_t>(y, x)));
      return real_picture;
    }
    if (channels >= 3) {
      std::vector<cv::Mat> planes;
      cv::split(picture, planes);
      cv::merge(std::vector<cv::Mat>{planes[2], planes[1], planes[0]}, picture);
    }
    return upright(grey(picture, file_), photometric, bits);
  }
  // Inverts a picture in which zero is white.
  static cv::Mat upright(const cv::Mat& picture, std::uint64_t photometric, std::uint64_t bits) {
    if (photometric != PHOTOMETRIC_MINISWHITE || picture.depth() == CV_32F) return picture;  // as is_inverted
    return cv::Scalar::all(static_cast<double>((1U << bits) - 1)) - picture;
  }
  // Pixels as stored on the page, row by row, from strips or tiles.
  [[nodiscard]] std::vector<std::uint8_t> raw_rows(std::size_t height, std::size_t row_bytes,
                                                   std::size_t pixel_bits) const {
    TIFF* t = tiff_.get();
    std::vector<std::uint8_t> rows(height * row_bytes);
    if (TIFFIsTiled(t) == 0) {
      std::uint32_t per_strip = 0;
      TIFFGetFieldDefaulted(t, TIFFTAG_ROWSPERSTRIP, &per_strip);
      per_strip = static_cast<std::uint32_t>(std::min<std::size_t>(std::max(per_strip, 1U), height));
      for (std::size_t y = 0; y < height; y += per_strip) {
        const auto wanted = static_cast<tmsize_t>(std::min<std::size_t>(per_strip, height - y) * row_bytes);
        if (TIFFReadEncodedStrip(t, static_cast<std::uint32_t>(y / per_strip), &rows[y * row_bytes],
                                 wanted) != wanted)
          damaged(fmt::format("is damaged or truncated in page {}", read_));
      }
      return rows;
    }
    std::uint32_t tile_width = 0, tile_height = 0;
    TIFFGetField(t, TIFFTAG_TILEWIDTH, &tile_width);
    TIFFGetField(t, TIFFTAG_TILELENGTH, &tile_height);
    require_plausible_size(file_, tile_width, tile_height, (pixel_bits + 7) / 8, file_size_);
    const std::size_t tile_row = (tile_width * pixel_bits + 7) / 8;
    std::vector<std::uint8_t> tile(tile_height * tile_row);
    const std::size_t across = (row_bytes + tile_row - 1) / tile_row;
    for (std::size_t y = 0, i = 0; y < height; y += tile_height)
      for (std::size_t column = 0; column < across; ++column, ++i) {
        const auto wanted = static_cast<tmsize_t>(tile.size());
        if (TIFFReadEncodedTile(t, static_cast<std::uint32_t>(i), tile.data(), wanted) != wanted)
          damaged(fmt::format("is damaged or truncated in page {}", read_));
        // The width of a tile is a multiple of 16 pixels, so that its rows begin at whole bytes for any
        // number of bits.
        const std::size_t n = std::min(tile_row, row_bytes - column * tile_row);
        for (std::size_t r = 0; r < tile_height && y + r < height; ++r)
          std::memcpy(&rows[(y + r) * row_bytes + column * tile_row], &tile[r * tile_row], n);
      }
    return rows;
  }
  // Palettes, 1 to 7 bits, JPEG in TIFF, separate planes: libtiff renders them with 8 bits.
  [[nodiscard]] cv::Mat by_rgba(std::uint32_t width, std::uint32_t height) const {
    std::vector<std::uint32_t> pixels(static_cast<std::size_t>(width) * height);
    // As the rows are stored: libtiff mirrors, but does not transpose, towards another orientation.
    const auto stored = static_cast<int>(field(TIFFTAG_ORIENTATION));
    if (TIFFReadRGBAImageOriented(tiff_.get(), width, height, pixels.data(), stored, 1) != 1)
      damaged(fmt::format("has a page {} of a kind that cannot be read", read_));
    const cv::Mat rgba(static_cast<int>(height), static_cast<int>(width), CV_8UC4, pixels.data());
    cv::Mat one;
    cv::cvtColor(rgba, one, cv::COLOR_RGBA2GRAY);
    return one;
  }

  fs::path file_;
  std::uint64_t file_size_;
  std::size_t pages_, read_ = 0;
  std::string complaint_;
  std::unique_ptr<TIFF, Close> tiff_;
  SizeGuard guard_;
  StackInfo info_;
};

}  // namespace

extern const Reader tiff_reader;
const Reader tiff_reader = {
    .extensions = kTiffEndings,
    .owns =
        [](const Head& head) {
          return head.starts_with({"II*\0", 4}) || head.starts_with({"MM\0*", 4}) ||
                 head.starts_with({"II+\0", 4}) || head.starts_with({"MM\0+", 4});
        },
    .open = [](const fs::path& file, const std::string&) -> std::unique_ptr<FrameSource> {
      const Walked walked = Walk(ByteFile(file)).run();
      const double planes = imagej(walked.description, "images").value_or(1);
      if (walked.pages == 1 && planes > 1) return std::make_unique<BarePlanes>(file, walked, planes);
      return std::make_unique<Pages>(file, walked);
    }};

}  // namespace twincell::imaging::frames
