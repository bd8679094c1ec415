// TrackMate, the tracker of Fiji: its own file (spots, edges, tracks), and read also the simple list of
// tracks that its action "Export tracks to XML file" writes and that of the ISBI challenge. y increases
// downwards, as in a picture. Source: TrackMate's manual, "TrackMate XML file format";
// fiji.plugin.trackmate.io.TmXmlReader, action.ExportTracksToXML.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <unordered_map>
#include <utility>

#include "core/escape.hpp"
#include "core/table_text.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/picture_beads.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

/// An XML text and its elements, which know their lines.
class XmlText {
 public:
  /// \param fail called with line and complaint; does not return
  XmlText(std::string text, const std::function<void(long, std::string)>& fail) : text_(std::move(text)) {
    for (std::size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1))
      line_ends_.push_back(static_cast<std::ptrdiff_t>(at));
    const pugi::xml_parse_result parsed = tree_.load_buffer(text_.data(), text_.size());
    if (!parsed)
      fail(line_of(parsed.offset), fmt::format("this is no well-formed XML ({}).", parsed.description()));
  }
  [[nodiscard]] pugi::xml_node root() const { return tree_.document_element(); }
  [[nodiscard]] long line_of(const pugi::xml_node& node) const { return line_of(node.offset_debug()); }

 private:
  [[nodiscard]] long line_of(std::ptrdiff_t offset) const {
    return 1 +
           std::distance(line_ends_.begin(), std::lower_bound(line_ends_.begin(), line_ends_.end(), offset));
  }
  std::string text_;
  std::vector<std::ptrdiff_t> line_ends_;
  pugi::xml_document tree_;
};

class TrackMateReader final : public PictureBeadsReader {
 public:
  TrackMateReader(const std::filesystem::path& file, const ReadOptions& options)
      : PictureBeadsReader(file, options),
        xml_(read_table_text(file), [this](long line, const std::string& what) { fail_at(line, what); }) {
    const pugi::xml_node root = xml_.root();
    const std::string_view name = root.name();
    if (name == "TrackMate")
      read_model(root.child("Model"));
    else if (name == "Tracks")
      read_list(root);
    else if (name == "root" && root.child("TrackContestISBI2012"))
      read_list(root.child("TrackContestISBI2012"));
    else
      fail_at(xml_.line_of(root),
              fmt::format("the element '{}' is neither TrackMate nor Tracks nor that of an "
                          "ISBI file.",
                          name.substr(0, 60)));
    if (beads_.empty()) fail_at(0, "the file has no tracks.");
    sort_by_frame();
  }

  [[nodiscard]] std::string length_unit() const override { return length_unit_; }
  [[nodiscard]] std::string time_unit() const override { return time_unit_; }

 private:
  [[nodiscard]] std::string_view needed(const pugi::xml_node& node, const char* name) const {
    const pugi::xml_attribute value = node.attribute(name);
    if (!value) fail_at(xml_.line_of(node), fmt::format("'{}' has no attribute '{}'.", node.name(), name));
    return value.value();
  }
  [[nodiscard]] std::int64_t whole(const pugi::xml_node& node, const char* name) const {
    return whole_at(xml_.line_of(node), needed(node, name));
  }
  [[nodiscard]] double number(const pugi::xml_node& node, const char* name) const {
    return number_at(xml_.line_of(node), needed(node, name));
  }
  [[nodiscard]] BeadOfFrame spot(const pugi::xml_node& node, const char* frame,
                                 const std::array<const char*, 3>& axes) const {
    const bool has_z = options_.dimension == 3 || node.attribute(axes[2]);
    BeadOfFrame spot{.frame = whole(node, frame)};
    spot.bead.line = xml_.line_of(node);
    spot.bead.type = 1;
    spot.bead.position =
        upright(Vec3(number(node, axes[0]), number(node, axes[1]), has_z ? number(node, axes[2]) : 0));
    return spot;
  }

  /// A list of tracks: <particle><detection t x y z/>...</particle>; TrackMate states the interval of frames.
  void read_list(const pugi::xml_node& list) {
    std::int64_t particle = 0;
    length_unit_ = list.attribute("spaceUnits").value();
    time_unit_ = list.attribute("timeUnits").value();
    const bool timed = list.attribute("frameInterval");
    const double interval = timed ? number(list, "frameInterval") : 0;
    if (timed && !(interval > 0))
      fail_at(xml_.line_of(list), fmt::format("frameInterval is {:g}; it must be above 0.", interval));
    for (const pugi::xml_node& track : list.children("particle")) {
      for (const pugi::xml_node& detection : track.children("detection")) {
        beads_.push_back(spot(detection, "t", {"x", "y", "z"}));
        beads_.back().bead.id = particle;
        if (timed) beads_.back().time = static_cast<double>(beads_.back().frame) * interval;
      }
      ++particle;
    }
  }

  /// A file of TrackMate: all spots, the edges of all tracks, and the tracks that passed the filters.
  void read_model(const pugi::xml_node& model) {
    std::unordered_map<std::int64_t, std::size_t> place;  // ID -> entry of beads_
    has_.radius = true;
    length_unit_ = model.attribute("spatialunits").value();
    time_unit_ = model.attribute("timeunits").value();
    for (const pugi::xml_node& frame : model.child("AllSpots").children("SpotsInFrame"))
      for (const pugi::xml_node& node : frame.children("Spot")) {
        BeadOfFrame found = spot(node, "FRAME", {"POSITION_X", "POSITION_Y", "POSITION_Z"});
        if (node.attribute("POSITION_T")) found.time = number(node, "POSITION_T");
        found.bead.radius = node.attribute("RADIUS") ? number(node, "RADIUS") : 0;
        has_.radius = has_.radius && found.bead.radius > 0;
        if (!place.emplace(whole(node, "ID"), beads_.size()).second)
          fail_at(found.bead.line, fmt::format("the spot {} occurs twice.", needed(node, "ID")));
        beads_.push_back(found);
      }
    std::unordered_map<std::int64_t, std::int64_t> track_of;
    for (const pugi::xml_node& track : model.child("AllTracks").children("Track"))
      for (const pugi::xml_node& edge : track.children("Edge"))
        for (const char* end : {"SPOT_SOURCE_ID", "SPOT_TARGET_ID"}) {
          const std::int64_t id = whole(edge, end), number = whole(track, "TRACK_ID");
          if (!place.contains(id)) fail_at(xml_.line_of(edge), fmt::format("there is no spot {}.", id));
          if (const auto [known, fresh] = track_of.emplace(id, number); !fresh && known->second != number)
            fail_at(xml_.line_of(edge),
                    fmt::format("the spot {} belongs to the tracks {} and {}.", id, known->second, number));
        }
    std::set<std::int64_t> shown;
    const pugi::xml_node filtered = model.child("FilteredTracks");
    for (const pugi::xml_node& track : filtered.children("TrackID")) shown.insert(whole(track, "TRACK_ID"));
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

  XmlText xml_;
  std::string length_unit_, time_unit_;
};

constexpr const char* kTrackMateMark = "<!-- written by twincell -->";

class TrackMateWriter final : public ForeignWriter {
 public:
  TrackMateWriter(const std::filesystem::path& part, const WriteOptions& options)
      : out_(part), options_(options) {
    out_.text() += fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n<TrackMate version=\"7.11.1\">\n<Model "
        "spatialunits=\"{}\" timeunits=\"{}\">\n<FeatureDeclarations>\n<SpotFeatures>\n",
        kTrackMateMark, html_text(options_.length_unit), html_text(options_.time_unit));
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

  void append(const ForeignFrame& s) override {
    auto text = std::back_inserter(out_.text());
    fmt::format_to(text, "<SpotsInFrame frame=\"{}\">\n", n_frames_);
    for (const ForeignBead& bead : s.beads) {
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
        -> std::unique_ptr<ForeignReader> { return std::make_unique<TrackMateReader>(file, options); },
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<TrackMateWriter>(part, options); },
    .mark = kTrackMateMark,
    .source = Origin::experiment};

}  // namespace twincell
