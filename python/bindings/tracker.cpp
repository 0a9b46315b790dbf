// Tracker: a picture at a time, as it comes from a camera.
#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/instrument_tracker.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"
#include "python/bindings/tracker.h"

namespace flextip::python {

InstrumentTrackerSetup TrackerSetupFor(const Recording& recording, const TrackerOptions& options,
                                       bool with_model) {
  if (!recording.cam0) throw InputError("recording: no cam0, tracking needs it");
  if (!recording.tags0) throw InputError("recording: no tags0, tracking needs it");
  InstrumentTrackerSetup setup = TrackerSetupOf(recording, options, with_model);
  setup.with_model = with_model;  // the wrist comes with the readings, not with a stream
  return setup;
}

std::vector<Image> PicturesFrom(const std::vector<std::optional<py::array>>& pictures) {
  std::vector<Image> images;
  images.reserve(pictures.size());
  for (const auto& picture : pictures) {
    images.push_back(picture ? ImageFrom(*picture) : Image());
  }
  return images;
}

std::vector<const Image*> PointersTo(const std::vector<Image>& images) {
  std::vector<const Image*> pointers;
  pointers.reserve(images.size());
  for (const Image& image : images) pointers.push_back(image.Empty() ? nullptr : &image);
  return pointers;
}

void AddTracker(py::module_& module) {
  using SharedTracker = Shared<InstrumentTracker>;
  const auto follow_all = [](SharedTracker& tracker,
                             const std::vector<std::optional<py::array>>& pictures, TimeNs t_ns,
                             const SensorReadings& readings) {
    const std::vector<Image> images = PicturesFrom(pictures);
    const std::vector<const Image*> pointers = PointersTo(images);
    const SensorReadings told = readings;
    return tracker.Use([&](InstrumentTracker& t) { return t.Follow(pointers, t_ns, told); });
  };
  py::class_<SharedTracker>(
      module, "Tracker",
      "Follows the tip in pictures as they come. Threads that share a tracker "
      "take turns.")
      .def(
          py::init([](const Recording& recording, const TrackerOptions& options, bool with_model) {
            return std::make_unique<SharedTracker>(TrackerSetupFor(recording, options, with_model));
          }),
          py::arg("recording"), py::kw_only(),
          py::arg_v("options", TrackerOptions(), "TrackerOptions()"), py::arg("with_model") = true,
          "recording: cameras, collar, instrument and port; its samples are not read. with_model: "
          "expect the tip by the wrist's readings and the shaft's model. Raises InputError for a "
          "camera or collar that cannot be used.")
      .def(
          "track",
          [follow_all](SharedTracker& tracker, const py::array& picture, TimeNs t_ns,
                       const SensorReadings& readings) {
            return follow_all(tracker, {picture}, t_ns, readings);
          },
          py::arg("picture"), py::arg("t_ns"),
          py::arg_v("readings", SensorReadings(), "Readings()"),
          R"doc(Finds the tip in a picture.

picture: uint8 (H, W), or (H, W, 3) in the order blue, green, red. t_ns: its time, after the last
one's. readings: the other sensors at that time (their tip is not looked at).

Returns a TipTrack: that there is no tip is its status. Raises InputError for another type or size
of picture.)doc")
      .def("track_stereo", follow_all, py::arg("pictures"), py::arg("t_ns"),
           py::arg_v("readings", SensorReadings(), "Readings()"),
           "Finds the tip in a picture of each camera taken at the same time; None where a camera "
           "has none.");
}

}  // namespace flextip::python
