#pragma once

#include <filesystem>
#include <string>

#include "reports/render/report.h"

namespace moma::reports {

struct VideoOptions {
  int width = 1280;                               ///< [px], 64 to 4096, even
  int height = 720;                               ///< [px], 64 to 4096, even
  double fps = 30.0;                              ///< frames per second, 1 to 120
  double speed = 1.0;                             ///< seconds of the motion per second of the film, > 0
  Look look;                                      ///< as in ReportOptions
  Simulate simulate;                              ///< as in ReportOptions
  files::Replace replace = files::Replace::kOwn;  ///< what may stand where the video goes
};

/// Frames of a motion of `duration` seconds: one at each k * speed / fps up to its end, and its end.
int frames_of(double duration, const VideoOptions& options);

/// Writes the motion of a trial, by its whole name, as the report page shows it: WebM (VP9), frame k at k / fps. Frames
/// follow from the store alone; no window is opened and no clock is looked at. Returns the number of frames. The file
/// appears whole or not at all.
/// Throws ReportError: options out of range, no such store or trial, no motion to be had, what Browser throws.
/// Cost: 0.1 s a frame of 1280 x 720 on one core.
int write_video(const std::filesystem::path& store, const std::string& trial, const std::filesystem::path& file,
                const VideoOptions& options);

}  // namespace moma::reports

namespace moma {
using reports::VideoOptions;
using reports::write_video;
}  // namespace moma
