// Pictures in messages as files.
#pragma once

#include <filesystem>
#include <string>

#include "exchange/bags/messages.h"

namespace flextip::exchange {

/// ".png" or ".jpg": what WritePicture makes of the message.
std::string PictureSuffix(const ImageMessage& message);

/// Writes the message's picture: a CompressedImage byte for byte, an Image as PNG without loss
/// (Bayer and YUV patterns as colours). Throws InputError, which begins with the file's name, for
/// an encoding that is not known, for too few bytes and without pixels; WorkError where the disk
/// refuses.
void WritePicture(const std::filesystem::path& file, const ImageMessage& message);

}  // namespace flextip::exchange
