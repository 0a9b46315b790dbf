#include "recording/frames/video_reader.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <system_error>
#include <utility>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/log.h>
#include <libswscale/swscale.h>
}

#include "recording/frames/video_info.h"

namespace flextip {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kLongestWait(30);  // for a stream that gives nothing
constexpr int kMostDamaged = 64;                  // packets in a row, of a stream

struct Free {
  void operator()(AVFormatContext* it) const { avformat_close_input(&it); }
  void operator()(AVCodecContext* it) const { avcodec_free_context(&it); }
  void operator()(AVPacket* it) const { av_packet_free(&it); }
  void operator()(AVFrame* it) const { av_frame_free(&it); }
  void operator()(SwsContext* it) const { sws_freeContext(it); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

double Value(AVRational ratio) { return ratio.den == 0 ? 0.0 : av_q2d(ratio); }

/// Returns the quarter turns to the right that set a picture upright.
int QuarterTurns(const AVStream& stream) {
  const std::uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
  if (!matrix) return 0;
  const double left_deg = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
  return std::isfinite(left_deg) ? (static_cast<int>(std::lround(-left_deg / 90.0)) + 8) % 4 : 0;
}

Image Turned(const cv::Mat& picture, int quarter_turns) {
  const bool lies = quarter_turns % 2 == 1;
  Image image(lies ? picture.rows : picture.cols, lies ? picture.cols : picture.rows, 3);
  cv::Mat target(image.height_px, image.width_px, CV_8UC3, image.data.data());
  constexpr int kRotations[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                cv::ROTATE_90_COUNTERCLOCKWISE};
  if (quarter_turns == 0) {
    picture.copyTo(target);
  } else {
    cv::rotate(picture, target, kRotations[quarter_turns - 1]);
  }
  return image;
}

}  // namespace

struct VideoReader::Impl {
  Kind kind = Kind::kFile;
  double most_pixels = kMostPixels;
  Clock::time_point deadline;
  Owned<AVFormatContext> container;
  Owned<AVCodecContext> decoder;
  Owned<AVPacket> packet{av_packet_alloc()};
  Owned<AVFrame> decoded{av_frame_alloc()}, colour{av_frame_alloc()};
  Owned<SwsContext> conversion;
  AVStream* stream = nullptr;  // the container's
  int quarter_turns = 0;

  static int IsLate(void* self) { return Clock::now() > static_cast<Impl*>(self)->deadline; }

  bool Open(const std::string& source) {
    AVFormatContext* opened = avformat_alloc_context();
    if (!opened) return false;
    opened->interrupt_callback = {IsLate, this};
    deadline = Clock::now() + kLongestWait;
    AVDictionary* options = nullptr;
    const bool file = kind == Kind::kFile;
    av_dict_set(&options, file ? "protocol_whitelist" : "rtsp_transport", file ? "file" : "tcp", 0);
    const std::string address = (file ? "file:" : "") + source;
    const int error = avformat_open_input(&opened, address.c_str(), nullptr, &options);
    av_dict_free(&options);
    if (error < 0) return false;  // `opened` is freed then
    container.reset(opened);
    return LookAtStreams() && OpenDecoder();
  }

  /// Decodes the first pictures of all streams for what the container does not state.
  bool LookAtStreams() {
    std::vector<AVDictionary*> of_streams(container->nb_streams, nullptr);
    for (AVDictionary*& one : of_streams)
      av_dict_set_int(&one, "max_pixels", static_cast<std::int64_t>(most_pixels), 0);
    const int error = avformat_find_stream_info(container.get(), of_streams.data());
    for (AVDictionary*& one : of_streams) av_dict_free(&one);
    return error >= 0;
  }

  bool OpenDecoder() {
    const AVCodec* codec = nullptr;
    const int found = av_find_best_stream(container.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (found < 0 || !codec) return false;
    stream = container->streams[found];
    for (unsigned i = 0; i < container->nb_streams; ++i) {
      if (static_cast<int>(i) != found) container->streams[i]->discard = AVDISCARD_ALL;
    }
    decoder.reset(avcodec_alloc_context3(codec));
    if (!decoder || avcodec_parameters_to_context(decoder.get(), stream->codecpar) < 0)
      return false;
    constexpr int kWorthThreads_px = 100'000;
    const bool large =
        stream->codecpar->width * std::int64_t{stream->codecpar->height} > kWorthThreads_px;
    decoder->thread_count = large ? 0 : 1;  // 0: as many as there are cores
    decoder->max_pixels = static_cast<std::int64_t>(most_pixels);
    quarter_turns = QuarterTurns(*stream);
    return avcodec_open2(decoder.get(), codec, nullptr) >= 0;
  }

  /// Sends the next packet of the stream, or the end. Returns FFmpeg's error.
  int Send() {
    while (av_read_frame(container.get(), packet.get()) >= 0) {
      const bool ours = packet->stream_index == stream->index;
      const int error = ours ? avcodec_send_packet(decoder.get(), packet.get()) : 0;
      av_packet_unref(packet.get());
      if (ours) return error;
    }
    return avcodec_send_packet(decoder.get(), nullptr);
  }

  bool Decode() {
    deadline = Clock::now() + kLongestWait;
    for (int damaged = 0; damaged <= kMostDamaged;) {
      int error = avcodec_receive_frame(decoder.get(), decoded.get());
      if (error == 0) return true;
      if (error == AVERROR(EAGAIN)) error = Send();
      if (error == AVERROR_EOF) return false;
      if (error < 0 && kind == Kind::kFile) return false;
      damaged = error < 0 ? damaged + 1 : damaged;
    }
    return false;
  }

  /// Makes `colour` the decoded picture in blue, green, red.
  bool Convert() {
    const auto format = static_cast<AVPixelFormat>(decoded->format);
    const int width = decoded->width, height = decoded->height;
    if (width <= 0 || height <= 0 || double(width) * height > kMostPixels) return false;
    conversion.reset(sws_getCachedContext(conversion.release(), width, height, format, width,
                                          height, AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr,
                                          nullptr));
    if (!conversion) return false;
    if (colour->width != width || colour->height != height) {
      av_frame_unref(colour.get());
      colour->format = AV_PIX_FMT_BGR24;
      colour->width = width;
      colour->height = height;
      if (av_frame_get_buffer(colour.get(), 0) < 0) return false;
    }
    return sws_scale(conversion.get(), decoded->data, decoded->linesize, 0, height, colour->data,
                     colour->linesize) == height;
  }
};

VideoReader::VideoReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoReader::~VideoReader() = default;

std::unique_ptr<VideoReader> VideoReader::Open(const std::string& source, Kind kind,
                                               double most_pixels) {
  std::error_code error;
  if (std::filesystem::is_regular_file(source, error) && !IsVideo(source)) return nullptr;
  av_log_set_level(AV_LOG_QUIET);
  auto impl = std::make_unique<Impl>();
  impl->kind = kind;
  impl->most_pixels = most_pixels;
  if (!impl->Open(source)) return nullptr;
  std::unique_ptr<VideoReader> reader(new VideoReader(std::move(impl)));
  if (reader->Width_px() <= 0 || reader->Height_px() <= 0) return nullptr;
  RefuseHugeVideo(source, reader->Width_px(), reader->Height_px());
  return reader;
}

int VideoReader::Width_px() const {
  const auto& size = *impl_->stream->codecpar;
  return impl_->quarter_turns % 2 == 1 ? size.height : size.width;
}

int VideoReader::Height_px() const {
  const auto& size = *impl_->stream->codecpar;
  return impl_->quarter_turns % 2 == 1 ? size.width : size.height;
}

double VideoReader::StatedRate() const {
  return Value(av_guess_frame_rate(impl_->container.get(), impl_->stream, nullptr));
}

double VideoReader::StatedFrames() const {
  const AVStream& stream = *impl_->stream;
  if (stream.nb_frames > 0) return static_cast<double>(stream.nb_frames);
  double duration_s = static_cast<double>(impl_->container->duration) / AV_TIME_BASE;
  if (duration_s <= 0) duration_s = static_cast<double>(stream.duration) * Value(stream.time_base);
  return std::max(0.0, std::floor(duration_s * StatedRate() + 0.5));
}

bool VideoReader::Advance() { return impl_->Decode(); }

std::optional<Image> VideoReader::Picture() {
  if (!impl_->Convert()) return {};
  const AVFrame& frame = *impl_->colour;
  const cv::Mat picture(frame.height, frame.width, CV_8UC3, frame.data[0],
                        static_cast<std::size_t>(frame.linesize[0]));
  return Turned(picture, impl_->quarter_turns);
}

}  // namespace flextip
