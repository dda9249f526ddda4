#include "commands/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "commands/tell.hpp"

namespace dapple {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr auto kLineEvery = std::chrono::seconds(10);
constexpr int kWidth = 32;
constexpr std::size_t kMaxName = 50;

std::string duration_text(double seconds) {
  const auto s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace

ProgressBar::ProgressBar(bool quiet, std::string verb)
    : verb_(std::move(verb)),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::show(double done) {
  const auto now = std::chrono::steady_clock::now();
  if (begun_ < 0) {
    begun_ = done;
    start_ = now;
  }
  if (quiet_ ||
      now - last_ <
          (terminal_ ? kRedraw : std::chrono::duration_cast<std::chrono::milliseconds>(kLineEvery)))
    return;
  if (!terminal_ && done <= begun_) return;  // how long it takes is not known
  last_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const std::string left =
      done > begun_ ? duration_text(elapsed * (1 - done) / (done - begun_)) + " left" : "starting";
  if (!terminal_) {
    tell("{}{}{}: {:.0f} %, {}\n", verb_, what_.empty() ? "" : " ", what_, 100 * done, left);
    return;
  }
  const int full = static_cast<int>(done * kWidth);
  tell("\r\033[K{}{}[{}{}] {:3.0f} %  {}", what_, what_.empty() ? "" : " ", std::string(full, '#'),
       std::string(kWidth - full, '.'), 100 * done, left);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::announce(const std::string& doing, const std::string& path) {
  if (quiet_ || !terminal_) return;
  const std::string name = std::filesystem::path(path).filename().string().substr(0, kMaxName);
  tell("\r\033[K{}{}{} {} ...", what_, what_.empty() ? "" : " ", doing, name);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::begin(const std::string& what) {
  what_ = what;
  begun_ = -1;
}

void ProgressBar::clear() {
  if (!drawn_) return;
  tell("\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace dapple
