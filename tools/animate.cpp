#include "tools/animate.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <optional>
#include <string_view>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/write_file.h"
#include "burin/base/image.h"
#include "burin/pictures/encoded_bytes.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/board_face.h"
#include "burin/scene/look_at.h"
#include "tools/animated_png.h"
#include "tools/automatic_exposure.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesAPlace = 8, kMostFrames = 240;

// A pinhole lens with the whole board in view from the nearest place.
Lens lens_for(const Board& board, double nearest_mm, int pixels) {
  const double rim_mm = 0.5 * board.size_mm.norm();
  const double focal_px = 0.48 * pixels * std::sqrt(std::max(nearest_mm * nearest_mm - rim_mm * rim_mm, 1e-6)) / rim_mm;
  Lens lens;
  lens.model = "LENSMODEL_PINHOLE";
  lens.intrinsics = {focal_px, focal_px, (pixels - 1) / 2.0, (pixels - 1) / 2.0};
  lens.width = lens.height = pixels;
  return lens;
}

struct Film {
  const Board& board;
  const Bench& bench;
  const Carved& carved;
  Lens lens;
  BoardFace face;

  Image radiance(const Eigen::Vector3d& eye_mm, const Light& light) const {
    const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
    const PixelWindow whole{0, 0, lens.width, lens.height};
    ViewScene scene =
        make_scene(bench, board, share(camera_grid(lens, look_at(eye_mm, middle), face, whole)), eye_mm, light);
    scene.hidden_from_light = hidden_pixels(*scene.grid, face, light.position_mm);
    RenderOptions options;
    options.channels = 3;
    options.material_gradients = false;
    Image image;
    ViewRenderer(std::move(scene), options).forward(carved, image);
    return image;
  }
};

std::string png_of(const Image& radiance, double exposure, const fs::path& file) {
  std::vector<std::uint8_t> stored(radiance.data.size());
  std::transform(radiance.data.begin(), radiance.data.end(), stored.begin(), [&](float v) {
    const float shown = linear_to_srgb(std::clamp(static_cast<float>(exposure) * v, 0.0F, 1.0F));
    return static_cast<std::uint8_t>(std::lround(255 * shown));
  });
  return png_bytes({radiance.width, radiance.height, radiance.channels, stored}, file);
}

fs::path numbered_frame(const fs::path& folder, int frame) {
  std::string number = std::to_string(frame);
  number.insert(0, number.size() < 4 ? 4 - number.size() : 0, '0');
  return folder / ("frame-" + number + ".png");
}

// A child process that reads bytes from standard input and never outlives this process. It ends with its input, or at
// once if this process is killed. PR_SET_PDEATHSIG acts at the end of the parent thread, which waits here.
class FedProgram {
 public:
  // The child gets `output` as descriptor 3. Throws Error if the system cannot start another process.
  FedProgram(std::vector<std::string> words, int output, const fs::path& for_file) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::array<int, 2> ends{-1, -1};
    // A socket, because writing to a broken pipe would end this process by a signal.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
      fail_with(for_file, "cannot be written: there is no pipe to " + words.front(), errno);
    input_ = Descriptor(ends[0]);
    const Descriptor theirs(ends[1]);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {  // other threads may hold locks: only system calls are safe
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      // Descriptors below 3 are open (fill_closed_streams), so these two do not collide.
      if (::getppid() == parent && ::dup2(theirs.number(), STDIN_FILENO) >= 0 && ::dup2(output, kOutput) >= 0 &&
          ::fcntl(kOutput, F_SETFD, 0) == 0)
        ::execvp(arguments[0], arguments.data());
      ::_exit(kNotStarted);
    }
    if (process_ < 0) fail_with(for_file, "cannot be written: " + words.front() + " cannot be started", errno);
  }
  ~FedProgram() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    end();
  }
  FedProgram(const FedProgram&) = delete;
  FedProgram& operator=(const FedProgram&) = delete;

  // Returns false if the child reads no more.
  bool feed(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(input_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  // Closes its input and waits for it. Returns its exit status; -1 after a signal.
  int end() {
    input_ = Descriptor();
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  static constexpr int kNotStarted = 127, kOutput = 3;

 private:
  Descriptor input_;
  pid_t process_ = -1;
};

// Frames are not written to files, and this process opens the film itself, so that a failure leaves no files.
void write_film(const std::vector<std::string>& frames, double frames_per_s, const fs::path& out) {
  write_atomically(out, [&](const fs::path& part) {
    const Descriptor film(::open(part.c_str(), O_RDWR | O_CLOEXEC));
    if (!film) fail_with(out, "cannot be written", errno);
    FedProgram ffmpeg({"ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "image2pipe", "-framerate",
                       std::to_string(frames_per_s), "-c:v", "png", "-i", "pipe:0", "-pix_fmt", "yuv420p", "-f", "mp4",
                       "/proc/self/fd/3"},
                      film.number(), out);
    const bool fed = std::all_of(frames.begin(), frames.end(), [&](const auto& frame) { return ffmpeg.feed(frame); });
    const int status = ffmpeg.end();
    if (status == FedProgram::kNotStarted)
      fail(out.string(), "a film is made by ffmpeg, which is not installed",
           "install it (apt install ffmpeg), or name a .png: an animated PNG, which browsers play");
    if (!fed || status != 0)
      fail(out.string(), "ffmpeg could not write it", "read its message above, or name a .png instead");
  });
}

// Returns the number of frames, including the way back.
int write_frames(std::vector<std::string> frames, const AnimateOptions& options, const fs::path& out) {
  if (options.there_and_back)
    for (std::size_t i = frames.size() - 1; i-- > 1;) frames.push_back(frames[i]);
  const double way = options.there_and_back ? 2 * options.seconds : options.seconds;
  const double frames_per_s = static_cast<double>(frames.size()) / way;
  if (out.extension() == ".png") {
    write_text(animated_png(frames, frames_per_s), out);
  } else if (out.extension() == ".mp4") {
    write_film(frames, frames_per_s, out);
  } else if (out.extension().empty()) {
    make_output_folder(out);
    FilesTogether all;
    for (std::size_t i = 0; i < frames.size(); ++i) write_text(frames[i], numbered_frame(out, static_cast<int>(i)));
    all.put();
  } else {
    fail(out.string(), "an animation is a .png, an .mp4, or a folder of numbered PNG files", "name one of these");
  }
  return static_cast<int>(frames.size());
}

}  // namespace

std::vector<Step> walk_through(std::span<const Eigen::Vector3d> places_mm, const Eigen::Vector3d& center_mm,
                               int frames) {
  std::vector<Step> steps;
  if (places_mm.size() < 2 || frames < 2) {
    if (!places_mm.empty()) steps.push_back({0, 0, places_mm.front()});
    return steps;
  }
  const auto turn = [&](std::size_t i) {
    const Eigen::Vector3d a = (places_mm[i] - center_mm).normalized(), b = (places_mm[i + 1] - center_mm).normalized();
    return std::max(1e-9, std::atan2(a.cross(b).norm(), a.dot(b)));
  };
  std::vector<double> until{0};
  for (std::size_t i = 0; i + 1 < places_mm.size(); ++i) until.push_back(until.back() + turn(i));
  for (int f = 0; f < frames; ++f) {
    const double at = until.back() * f / (frames - 1);
    const auto after = std::upper_bound(until.begin() + 1, until.end() - 1, at);
    const auto i = static_cast<std::size_t>(after - until.begin()) - 1;
    const double whole = until[i + 1] - until[i], share = std::clamp((at - until[i]) / whole, 0.0, 1.0);
    const Eigen::Vector3d a = places_mm[i] - center_mm, b = places_mm[i + 1] - center_mm;
    const Eigen::Vector3d direction = whole < 1e-6 ? a.normalized()
                                                   : Eigen::Vector3d((std::sin((1 - share) * whole) * a.normalized() +
                                                                      std::sin(share * whole) * b.normalized()) /
                                                                     std::sin(whole));
    steps.push_back({i, share, center_mm + ((1 - share) * a.norm() + share * b.norm()) * direction.normalized()});
  }
  return steps;
}

int animate(const Board& board, const Bench& bench, const Carved& carved, std::span<const View> views,
            std::span<const Light> lights, const fs::path& out, const AnimateOptions& options,
            const Progress& progress) {
  const bool eye_moves = options.moving == Moving::eye;
  std::vector<Eigen::Vector3d> places;
  for (const View& view : views)
    if (eye_moves) places.push_back(view.T_camera_board.inverse().translation());
  for (const Light& light : lights)
    if (!eye_moves) places.push_back(light.position_mm);
  if (places.size() < 2)
    fail(out.string(), std::string("there is only one ") + (eye_moves ? "view" : "lamp") + " to move through",
         eye_moves ? "name two views or more with --view, or let the lamp move: --moving lamp"
                   : "name two lamps or more with --light, or let the eye move: --moving eye");
  if (views.empty() || lights.empty()) fail(out.string(), "there is no view or no lamp", "add one to the bench");
  const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  const Eigen::Vector3d still_eye = views.front().T_camera_board.inverse().translation();
  double nearest = (still_eye - middle).norm();
  for (const Eigen::Vector3d& place : places)
    if (eye_moves) nearest = std::min(nearest, (place - middle).norm());
  const Film film{board, bench, carved, lens_for(board, nearest, options.pixels), face_of(board, bench)};
  const auto seen = [&](const Eigen::Vector3d& moving_mm) {
    Light light = lights.front();
    if (!eye_moves) light.position_mm = moving_mm;
    return film.radiance(eye_moves ? moving_mm : still_eye, light);
  };

  std::vector<double> log_exposure;
  for (std::size_t i = 0; i < places.size(); ++i) {
    progress("looking from each place", static_cast<double>(i) / static_cast<double>(places.size()));
    std::optional<double> exposure = options.exposure;
    if (!(options.exposure > 0)) exposure = automatic_exposure(seen(places[i]));
    if (!exposure)
      fail(eye_moves ? "view " + views[i].name : "lamp " + lights[i].id, "the board is black from there",
           "check that eye and lamp are in front of the board");
    log_exposure.push_back(std::log(*exposure));
  }
  const int usual = std::min(kMostFrames, kFramesAPlace * static_cast<int>(places.size() - 1) + 1);
  const std::vector<Step> steps = walk_through(places, middle, options.frames > 0 ? options.frames : usual);
  std::vector<std::string> frames;
  for (const Step& step : steps) {
    progress("rendering frames", static_cast<double>(frames.size()) / static_cast<double>(steps.size()));
    const double exposure = std::exp((1 - step.share) * log_exposure[step.from] +
                                     step.share * log_exposure[std::min(step.from + 1, log_exposure.size() - 1)]);
    frames.push_back(png_of(seen(step.position_mm), exposure, out));
  }
  return write_frames(std::move(frames), options, out);
}

}  // namespace burin
