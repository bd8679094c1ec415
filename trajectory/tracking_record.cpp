#include "trajectory/tracking_record.hpp"

#include <nlohmann/json.hpp>

#include "core/json_view.hpp"

namespace twincell {
namespace {

/// The report; no object if it is absent or damaged.
nlohmann::json report_of(const TrajectoryInfo& info) {
  return nlohmann::json::parse(info.tracking_json, nullptr, false);
}

/// The member at a path of the report; null if it is absent.
nlohmann::json member_of(const TrajectoryInfo& info, const char* path) {
  const nlohmann::json report = report_of(info);
  const nlohmann::json::json_pointer at(path);
  return report.is_object() && report.contains(at) ? report.at(at) : nlohmann::json();
}

}  // namespace

std::optional<TrackedCamera> tracked_camera(const TrajectoryInfo& info, const std::string& name) {
  if (info.tracking_json.empty()) return std::nullopt;
  const auto camera = JsonView::parse(info.tracking_json, name).find("camera");
  if (!camera) return std::nullopt;
  constexpr double kLargest_px = 1e9;
  const auto origin = camera->at("origin_px").elements(2);
  TrackedCamera read{.pixels_per_sigma = camera->at("pixels_per_sigma").number_in(1e-3, kLargest_px),
                     .origin_x_px = origin[0].number_in(-kLargest_px, kLargest_px),
                     .origin_y_px = origin[1].number_in(-kLargest_px, kLargest_px),
                     .width_px = static_cast<int>(camera->at("width_px").integer(1, 1 << 30)),
                     .height_px = static_cast<int>(camera->at("height_px").integer(1, 1 << 30)),
                     .scale_error_px = {}};
  if (const auto error = camera->find("scale_error_px"))
    read.scale_error_px = error->number_in(0, kLargest_px);
  if (const auto turned = camera->find("rotation_deg")) read.rotation_deg = turned->number_in(-180, 180);
  if (const auto bent = camera->find("distortion")) read.distortion = bent->number_in(-1, 1);
  return read;
}

bool tracked_as_bright(const TrajectoryInfo& info) {
  return member_of(info, "/camera/bright") == true;
}

std::optional<int> tracked_first_phase(const TrajectoryInfo& info) {
  const nlohmann::json phase = member_of(info, "/phase_lock/first_phase");
  if (!phase.is_number_integer()) return std::nullopt;
  const auto number = phase.get<std::int64_t>();
  return number >= 0 && number < info.phases_per_cycle ? std::optional(static_cast<int>(number))
                                                       : std::nullopt;
}

std::optional<double> tracked_amplitude_error(const TrajectoryInfo& info) {
  const nlohmann::json amplitude = member_of(info, "/drive_check/amplitude"),
                       error = member_of(info, "/drive_check/amplitude_error");
  if (!amplitude.is_number() || !error.is_number() || amplitude <= 0 || error < 0) return std::nullopt;
  return error.get<double>() / amplitude.get<double>();
}

std::optional<std::string> recorded_disagreement(const TrajectoryInfo& info) {
  const nlohmann::json report = report_of(info);
  if (!report.is_object()) return std::nullopt;
  if (const auto clause = report.find("drive_disagreement"); clause != report.end())
    return clause->is_string() ? clause->get<std::string>() : "the stated drive does not fit the film";
  return report.contains("drive_check") ? std::optional(std::string()) : std::nullopt;
}

}  // namespace twincell
