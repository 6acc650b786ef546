#include "image/exr_chunks.hpp"

#include <openexr.h>

#include <algorithm>
#include <stdexcept>

namespace greenray {

namespace {

void say_nothing(exr_const_context_t, exr_result_t, const char *) {}

void check(exr_result_t result) {
  if (result != EXR_ERR_SUCCESS) throw std::runtime_error(exr_get_default_error_message(result));
}

/// A decoder at work on one chunk after the other.
class Decoder {
 public:
  Decoder(exr_const_context_t file) : file_(file) {}
  Decoder(const Decoder &) = delete;
  Decoder &operator=(const Decoder &) = delete;
  ~Decoder() {
    if (ready_) exr_decoding_destroy(file_, &pipeline_);
  }

  void start(const exr_chunk_info_t &chunk) {
    if (ready_) return check(exr_decoding_update(file_, 0, &chunk, &pipeline_));
    check(exr_decoding_initialize(file_, 0, &chunk, &pipeline_));
    ready_ = true;
  }
  /// to: first pixel of the chunk; width: of a row.
  void set_output(const std::string &channel, float *to, int width) {
    for (int i = 0; i < pipeline_.channel_count; ++i) {
      exr_coding_channel_info_t &info = pipeline_.channels[i];
      if (channel != info.channel_name) continue;
      info.decode_to_ptr = reinterpret_cast<std::uint8_t *>(to);
      info.user_bytes_per_element = sizeof(float);
      info.user_data_type = EXR_PIXEL_FLOAT;
      info.user_pixel_stride = sizeof(float);
      info.user_line_stride = width * static_cast<std::int32_t>(sizeof(float));
    }
  }
  void run() {
    check(exr_decoding_choose_default_routines(file_, 0, &pipeline_));
    check(exr_decoding_run(file_, 0, &pipeline_));
  }

 private:
  exr_const_context_t file_;
  exr_decode_pipeline_t pipeline_ = EXR_DECODE_PIPELINE_INITIALIZER;
  bool ready_ = false;
};

}  // namespace

struct ExrChunks::State {
  exr_context_t file = nullptr;
  int top = 0, width = 0, height = 0, rows_per_chunk = 1;
  ~State() {
    if (file) exr_finish(&file);
  }
};

ExrChunks::ExrChunks(std::unique_ptr<State> state) : state_(std::move(state)) {}
ExrChunks::~ExrChunks() = default;

std::unique_ptr<ExrChunks> ExrChunks::open(const std::filesystem::path &path) {
  auto state = std::make_unique<State>();
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.error_handler_fn = say_nothing;
  exr_storage_t storage = EXR_STORAGE_DEEP_SCANLINE;
  exr_compression_t compression = EXR_COMPRESSION_NONE;
  exr_attr_box2i_t window;
  if (exr_start_read(&state->file, path.c_str(), &settings) != EXR_ERR_SUCCESS) return nullptr;
  if (exr_get_storage(state->file, 0, &storage) != EXR_ERR_SUCCESS || storage != EXR_STORAGE_SCANLINE) return nullptr;
  // of the lossy ones, the C library of OpenEXR 3.1 mixes up the rows of floats in B44 and does not know DWA
  if (exr_get_compression(state->file, 0, &compression) != EXR_ERR_SUCCESS || compression > EXR_COMPRESSION_PXR24)
    return nullptr;
  if (exr_get_data_window(state->file, 0, &window) != EXR_ERR_SUCCESS ||
      exr_get_scanlines_per_chunk(state->file, 0, &state->rows_per_chunk) != EXR_ERR_SUCCESS)
    return nullptr;
  state->top = window.min.y;
  state->width = window.max.x - window.min.x + 1, state->height = window.max.y - window.min.y + 1;
  if (state->width < 1 || state->height < 1 || state->rows_per_chunk < 1) return nullptr;
  return std::unique_ptr<ExrChunks>(new ExrChunks(std::move(state)));
}

void ExrChunks::read(int first_row, int rows, const std::vector<std::string> &channels, float *planes) const {
  const auto width = static_cast<std::size_t>(state_->width), count = width * static_cast<std::size_t>(rows);
  const int end_row = first_row + rows, step = state_->rows_per_chunk;
  Decoder decoder(state_->file);
  std::vector<float> whole;  // of a chunk that is only wanted in part
  for (int chunk_row = first_row / step * step; chunk_row < end_row; chunk_row += step) {
    exr_chunk_info_t chunk;
    check(exr_read_scanline_chunk_info(state_->file, 0, state_->top + chunk_row, &chunk));
    if (chunk.width != state_->width || chunk.height != std::min(step, state_->height - chunk_row))
      throw std::runtime_error("a chunk of another size");
    const bool inside = chunk_row >= first_row && chunk_row + chunk.height <= end_row;
    const std::size_t chunk_count = width * static_cast<std::size_t>(chunk.height);
    if (!inside) whole.resize(channels.size() * chunk_count);
    decoder.start(chunk);
    for (std::size_t k = 0; k < channels.size(); ++k) {
      float *to = inside ? planes + k * count + width * static_cast<std::size_t>(chunk_row - first_row)
                         : whole.data() + k * chunk_count;
      decoder.set_output(channels[k], to, state_->width);
    }
    decoder.run();
    if (inside) continue;
    const int from = std::max(first_row, chunk_row), to = std::min(end_row, chunk_row + chunk.height);
    for (std::size_t k = 0; k < channels.size(); ++k)
      std::copy_n(whole.data() + k * chunk_count + width * static_cast<std::size_t>(from - chunk_row),
                  width * static_cast<std::size_t>(to - from),
                  planes + k * count + width * static_cast<std::size_t>(from - first_row));
  }
}

}  // namespace greenray
