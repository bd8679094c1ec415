// TrackMate, the tracker of Fiji: its own file (spots, edges, tracks), and read also the simple list of
// tracks that its action "Export tracks to XML file" writes. y increases downwards, as in a picture. Source:
// TrackMate's manual, "TrackMate XML file format"; fiji.plugin.trackmate.io.TmXmlReader,
// action.ExportTracksToXML.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/escape.hpp"
#include "core/table_text.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/picture_beads.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

/// A tag of an XML text.
struct Tag {
  std::string_view name;
  bool ends = false;  ///< </name>
  long line = 0;
  std::vector<std::pair<std::string_view, std::string_view>> attributes;

  [[nodiscard]] const std::string_view* attribute(std::string_view wanted) const {
    for (const auto& [known, value] : attributes)
      if (known == wanted) return &value;
    return nullptr;
  }
};

/// The tags of an XML text, one after another. Text between tags, comments and declarations are skipped;
/// entities in values stay as they are, because numbers have none.
class Tags {
 public:
  /// \param fail called with line and complaint; does not return
  Tags(std::string_view text, std::function<void(long, std::string)> fail)
      : text_(text), fail_(std::move(fail)) {}

  /// \returns false at the end of the text
  bool next(Tag& tag) {
    for (;;) {
      move_to(std::min(text_.find('<', at_), text_.size()));
      if (at_ == text_.size()) return false;
      if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) continue;
      break;
    }
    tag = {.line = line_};
    move_to(at_ + 1);
    if (peek() == '/') {
      tag.ends = true;
      move_to(at_ + 1);
    }
    tag.name = word();
    if (tag.name.empty()) fail_(line_, "'<' without the name of an element.");
    for (;;) {
      space();
      if (peek() == '/') move_to(at_ + 1);
      if (peek() == '>') break;
      const std::string_view name = word();
      space();
      if (name.empty() || peek() != '=')
        fail_(line_, fmt::format("the element '{}' is malformed.", tag.name));
      move_to(at_ + 1);
      space();
      const char quote = peek();
      const std::size_t end =
          quote == '"' || quote == '\'' ? text_.find(quote, at_ + 1) : std::string_view::npos;
      if (end == std::string_view::npos)
        fail_(line_, fmt::format("the value of '{}' has no closing quote.", name));
      tag.attributes.emplace_back(name, text_.substr(at_ + 1, end - at_ - 1));
      move_to(end + 1);
    }
    move_to(at_ + 1);
    return true;
  }
  [[nodiscard]] long line() const { return line_; }

 private:
  void move_to(std::size_t to) {
    line_ += std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                        text_.begin() + static_cast<std::ptrdiff_t>(to), '\n');
    at_ = to;
  }
  /// The next character. An element that is open at the end of the text is refused.
  [[nodiscard]] char peek() const {
    if (at_ >= text_.size()) fail_(line_, "the file ends inside an element.");
    return text_[at_];
  }
  bool skip(std::string_view begin, std::string_view end) {
    if (!text_.substr(at_).starts_with(begin)) return false;
    const std::size_t to = text_.find(end, at_ + begin.size());
    if (to == std::string_view::npos)
      fail_(line_, fmt::format("'{}' is never followed by '{}'.", begin, end));
    move_to(to + end.size());
    return true;
  }
  void space() { move_to(std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size())); }
  std::string_view word() {
    const std::size_t begin = at_;
    move_to(std::min(text_.find_first_of(" \t\r\n=/>\"'<", at_), text_.size()));
    return text_.substr(begin, at_ - begin);
  }

  std::string_view text_;
  std::function<void(long, std::string)> fail_;
  std::size_t at_ = 0;
  long line_ = 1;
};

class TrackMateReader final : public PictureBeadsReader {
 public:
  TrackMateReader(const std::filesystem::path& file, const ReadOptions& options)
      : PictureBeadsReader(file, options) {
    const std::string text = read_table_text(file);
    Tags tags(text, [this](long line, const std::string& what) { fail_at(line, what); });
    Tag tag;
    if (!tags.next(tag)) fail_at(0, "there is no XML element.");
    if (tag.name == "TrackMate")
      read_model(tags);
    else if (tag.name == "Tracks")
      read_list(tags);
    else
      fail_at(tag.line,
              fmt::format("the element '{}' is neither TrackMate nor Tracks.", tag.name.substr(0, 60)));
    if (beads_.empty()) fail_at(0, "the file has no tracks.");
    sort_by_frame();
  }

 private:
  [[nodiscard]] std::string_view needed(const Tag& tag, std::string_view name) const {
    const std::string_view* value = tag.attribute(name);
    if (value == nullptr) fail_at(tag.line, fmt::format("'{}' has no attribute '{}'.", tag.name, name));
    return *value;
  }
  [[nodiscard]] std::int64_t whole(const Tag& tag, std::string_view name) const {
    return whole_at(tag.line, needed(tag, name));
  }
  [[nodiscard]] double number(const Tag& tag, std::string_view name) const {
    return number_at(tag.line, needed(tag, name));
  }
  [[nodiscard]] Vec3 position(const Tag& tag, const std::array<const char*, 3>& names) const {
    const bool deep = options_.dimension == 3;
    return upright(Vec3(number(tag, names[0]), number(tag, names[1]), deep ? number(tag, names[2]) : 0));
  }

  /// A list of tracks: <particle><detection t x y z/>...</particle>.
  void read_list(Tags& tags) {
    Tag tag;
    std::int64_t particle = -1;
    while (tags.next(tag)) {
      if (tag.name == "particle" && !tag.ends) ++particle;
      if (tag.name != "detection" || tag.ends) continue;
      if (particle < 0) fail_at(tag.line, "a detection belongs to no particle.");
      BeadOfFrame spot{.frame = whole(tag, "t")};
      spot.bead.id = particle;
      spot.bead.line = tag.line;
      spot.bead.type = 1;
      spot.bead.position = position(tag, {"x", "y", "z"});
      beads_.push_back(spot);
    }
  }

  /// A file of TrackMate: all spots, the edges of all tracks, and the tracks that passed the filters.
  void read_model(Tags& tags) {
    std::unordered_map<std::int64_t, std::size_t> place;  // ID -> entry of beads_
    std::unordered_map<std::int64_t, std::int64_t> track_of;
    std::set<std::int64_t> shown;
    bool filtered = false;
    std::int64_t track = -1;
    Tag tag;
    has_.radius = true;
    while (tags.next(tag)) {
      if (tag.ends) continue;
      if (tag.name == "Spot") {
        BeadOfFrame spot{.frame = whole(tag, "FRAME")};
        if (tag.attribute("POSITION_T") != nullptr) spot.time = number(tag, "POSITION_T");
        spot.bead.line = tag.line;
        spot.bead.type = 1;
        spot.bead.radius = tag.attribute("RADIUS") != nullptr ? number(tag, "RADIUS") : 0;
        has_.radius = has_.radius && spot.bead.radius > 0;
        spot.bead.position = position(tag, {"POSITION_X", "POSITION_Y", "POSITION_Z"});
        if (!place.emplace(whole(tag, "ID"), beads_.size()).second)
          fail_at(tag.line, fmt::format("the spot {} occurs twice.", needed(tag, "ID")));
        beads_.push_back(spot);
      } else if (tag.name == "Track") {
        track = whole(tag, "TRACK_ID");
      } else if (tag.name == "Edge") {
        for (const char* end : {"SPOT_SOURCE_ID", "SPOT_TARGET_ID"}) {
          const std::int64_t id = whole(tag, end);
          if (!place.contains(id)) fail_at(tag.line, fmt::format("there is no spot {}.", id));
          if (track < 0) fail_at(tag.line, "an edge belongs to no track.");
          if (const auto [known, fresh] = track_of.emplace(id, track); !fresh && known->second != track)
            fail_at(tag.line,
                    fmt::format("the spot {} belongs to the tracks {} and {}.", id, known->second, track));
        }
      } else if (tag.name == "FilteredTracks") {
        filtered = true;
      } else if (tag.name == "TrackID") {
        shown.insert(whole(tag, "TRACK_ID"));
      }
    }
    keep_tracked(place, track_of, filtered ? &shown : nullptr);
  }

  /// Keeps the spots of the tracks that are shown. In a single frame no track exists, and every spot is a
  /// bead.
  void keep_tracked(const std::unordered_map<std::int64_t, std::size_t>& place,
                    const std::unordered_map<std::int64_t, std::int64_t>& track_of,
                    const std::set<std::int64_t>* shown) {
    const bool single = std::all_of(beads_.begin(), beads_.end(),
                                    [&](const BeadOfFrame& s) { return s.frame == beads_.front().frame; });
    std::vector<bool> kept(beads_.size(), false);
    for (const auto& [id, k] : place) {
      const auto track = track_of.find(id);
      if (track == track_of.end() && !single) continue;
      if (track != track_of.end() && shown != nullptr && !shown->contains(track->second)) continue;
      beads_[k].bead.id = track == track_of.end() ? id : track->second;
      kept[k] = true;
    }
    std::vector<BeadOfFrame> tracked;
    for (std::size_t k = 0; k < beads_.size(); ++k)
      if (kept[k]) tracked.push_back(beads_[k]);
    beads_ = std::move(tracked);
  }
};

class TrackMateWriter final : public SnapshotWriter {
 public:
  TrackMateWriter(const std::filesystem::path& part, const WriteOptions& options)
      : out_(part), options_(options) {
    out_.text() += fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<TrackMate version=\"7.11.1\">\n<Model "
        "spatialunits=\"{}\" "
        "timeunits=\"{}\">\n<FeatureDeclarations>\n<SpotFeatures>\n",
        html_text(options_.length_unit), html_text(options_.time_unit));
    constexpr const char* kFeatures[][4] = {
        {"QUALITY", "Quality", "QUALITY", "false"}, {"POSITION_X", "X", "POSITION", "false"},
        {"POSITION_Y", "Y", "POSITION", "false"},   {"POSITION_Z", "Z", "POSITION", "false"},
        {"POSITION_T", "T", "TIME", "false"},       {"FRAME", "Frame", "NONE", "true"},
        {"RADIUS", "Radius", "LENGTH", "false"},    {"VISIBILITY", "Visibility", "NONE", "true"}};
    for (const auto& [feature, name, dimension, whole] : kFeatures)
      out_.text() += fmt::format(
          "<Feature feature=\"{}\" name=\"{}\" shortname=\"{}\" dimension=\"{}\" isint=\"{}\"/>\n", feature,
          name, name, dimension, whole);
    out_.text() += "</SpotFeatures>\n<EdgeFeatures/>\n<TrackFeatures/>\n</FeatureDeclarations>\n<AllSpots>\n";
  }

  void append(const Snapshot& s) override {
    auto text = std::back_inserter(out_.text());
    fmt::format_to(text, "<SpotsInFrame frame=\"{}\">\n", n_frames_);
    for (const SnapshotBead& bead : s.beads) {
      const Vec3 r = to_picture(bead.position, options_.dimension);
      fmt::format_to(text,
                     "<Spot ID=\"{}\" name=\"{}\" QUALITY=\"1\" POSITION_X=\"{}\" POSITION_Y=\"{}\" "
                     "POSITION_Z=\"{}\" POSITION_T=\"{}\" FRAME=\"{}\" RADIUS=\"{}\" VISIBILITY=\"1\"/>\n",
                     n_beads_, bead.id, r.x(), r.y(), r.z(), s.time.value_or(0), n_frames_,
                     options_.columns.radius ? bead.radius : 0.5);
      beads_of_[bead.id].push_back(n_beads_++);
    }
    out_.text() += "</SpotsInFrame>\n";
    last_time_ = s.time.value_or(0);
    if (n_frames_++ == 0) first_time_ = last_time_;
    low_ = low_.cwiseMin(s.lower), high_ = high_.cwiseMax(s.upper);
    out_.flush_if_large();
  }

  void finish() override {
    auto text = std::back_inserter(out_.text());
    out_.text() += "</AllSpots>\n<AllTracks>\n";
    for (const auto& [bead, spots] : beads_of_) {
      if (spots.size() < 2) continue;
      fmt::format_to(text, "<Track name=\"{0}\" TRACK_ID=\"{0}\">\n", bead);
      for (std::size_t k = 1; k < spots.size(); ++k)
        fmt::format_to(text, "<Edge SPOT_SOURCE_ID=\"{}\" SPOT_TARGET_ID=\"{}\" LINK_COST=\"-1\"/>\n",
                       spots[k - 1], spots[k]);
      out_.text() += "</Track>\n";
      out_.flush_if_large();
    }
    out_.text() += "</AllTracks>\n<FilteredTracks>\n";
    for (const auto& [bead, spots] : beads_of_)
      if (spots.size() > 1) fmt::format_to(text, "<TrackID TRACK_ID=\"{}\"/>\n", bead);
    const double interval =
        n_frames_ > 1 ? (last_time_ - first_time_) / static_cast<double>(n_frames_ - 1) : 1;
    const Vec3 size = n_frames_ > 0 ? Vec3(high_ - low_) : Vec3(Vec3::Zero());
    fmt::format_to(
        text,
        "</FilteredTracks>\n</Model>\n<Settings>\n<ImageData filename=\"\" folder=\"\" width=\"{}\" "
        "height=\"{}\" nslices=\"1\" nframes=\"{}\" pixelwidth=\"1\" pixelheight=\"1\" "
        "voxeldepth=\"1\" timeinterval=\"{}\"/>\n</Settings>\n</TrackMate>\n",
        static_cast<long>(size.x()) + 1, static_cast<long>(size[options_.dimension - 1]) + 1, n_frames_,
        interval);
    out_.close();
  }

 private:
  TextOutput out_;
  WriteOptions options_;
  std::map<std::int64_t, std::vector<std::int64_t>> beads_of_;  ///< bead -> spots in the order of the frames
  std::int64_t n_frames_ = 0, n_beads_ = 0;
  double first_time_ = 0, last_time_ = 0;
  Vec3 low_ = Vec3::Constant(1e300), high_ = Vec3::Constant(-1e300);
};

}  // namespace

extern const ForeignFormat track_mate_format;
const ForeignFormat track_mate_format = {
    .word = "trackmate",
    .extensions = ".xml",
    .help = "TrackMate's file (y downwards): Fiji",
    .open = [](const std::filesystem::path& file, const ReadOptions& options)
        -> std::unique_ptr<SnapshotReader> { return std::make_unique<TrackMateReader>(file, options); },
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<SnapshotWriter> { return std::make_unique<TrackMateWriter>(part, options); },
    .source = "experiment"};

}  // namespace twincell
