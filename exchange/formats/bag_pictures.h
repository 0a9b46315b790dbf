// The pictures of a topic as cam0 or cam1.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exchange/bags/bags.h"
#include "exchange/bags/messages.h"
#include "exchange/formats/formats.h"

namespace flextip::exchange {

/// Lists a camera's pictures as they come, and writes them in a second pass: they need not fit into
/// memory.
class BagPictures {
 public:
  /// `name`: cam0 or cam1.
  BagPictures(std::string name, const CameraPlan& plan, const Bags& bags);

  /// Adds what is to be read: the pictures and the CameraInfo beside them.
  void Want(std::map<std::string, Bags::Take>& takes);

  /// Makes the camera. Returns false where nothing tells its lens.
  bool Finish(CameraPlan& plan, const std::shared_ptr<const Bags>& bags, Streams& streams,
              ImportLog& log);

 private:
  struct Picture {
    TimeNs t_ns = 0;
    long number = 0;  ///< of the message
    std::string suffix;
  };

  void TakePicture(const BagMessage& message, long number);
  void TakeInfo(const BagMessage& message);
  void SortPictures(ImportLog& log);

  std::string name_, topic_, info_topic_;
  TimeNs offset_ns_ = 0;
  bool stamped_ = true;
  int width_px_ = 0, height_px_ = 0;
  std::vector<Picture> pictures_;
  std::optional<CameraInfoMessage> info_;
};

}  // namespace flextip::exchange
