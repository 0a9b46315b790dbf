// A viewer made with the protocol's own library reads what a run publishes.
#include "live/publish/publisher.h"

#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlMessageHeader.h>
#include <igtlNDArrayMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlTransformMessage.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "kinematics/rod.h"
#include "pipeline/estimated_shape.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

constexpr TimeNs kTime_ns = 1'700'000'000'000'000'000;

Session Published() {
  Session session = ReadSession(WriteSession(SessionText()));
  session.publish.emplace();
  session.publish->rate_hz = 100.0;
  return session;
}

/// A command with an estimate of a shaft bent by a load.
ControllerCommand BentShaft(const Session& session) {
  const RodProblem problem{
      0.6, 0.304, {-0.2457, 0.0, 0.3421}, {0.0, 0.0, 0.17}, {0.3, -1.2, 0.5}, {0, 0, 0}};
  const RodState rod = RodSolver().Solve(problem);
  EXPECT_TRUE(rod.IsUsable());
  ControllerCommand command;
  command.t_ns = kTime_ns;
  command.status = ControlStatus::kOk;
  Measurements& z = command.measurements;
  z.p_RW = problem.p_wrist;
  z.wrist_position_noise_m = 5e-5;
  z.load = LoadMeasurement{problem.f_tip, 0.005};
  ShaftEstimator estimator(EstimatorOptionsFor(session.base.instrument, session.base.p_RP,
                                               Eigen::Vector3d::Zero(), 1e-4));
  command.estimate = estimator.Update(z);
  EXPECT_EQ(command.estimate.status, EstimateStatus::kOk);
  return command;
}

/// Messages by device, as the library unpacks them.
class Viewer {
 public:
  explicit Viewer(int port) : socket_(igtl::ClientSocket::New()) {
    EXPECT_EQ(socket_->ConnectToServer("127.0.0.1", port), 0);
    socket_->SetReceiveTimeout(5000);
  }
  ~Viewer() { socket_->CloseSocket(); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Returns the next message of `device`; null where none comes.
  igtl::MessageBase::Pointer Next(const std::string& device) {
    for (int i = 0; i < 100; ++i) {
      auto header = igtl::MessageHeader::New();
      header->InitPack();
      bool timeout = false;
      if (socket_->Receive(header->GetPackPointer(), header->GetPackSize(), timeout) == 0)
        return {};
      header->Unpack();
      igtl::MessageBase::Pointer message = Made(header->GetDeviceType());
      if (message.IsNull()) return {};
      message->SetMessageHeader(header);
      message->AllocatePack();
      socket_->Receive(message->GetPackBodyPointer(), message->GetPackBodySize(), timeout);
      const int unpacked = message->Unpack(1);
      EXPECT_TRUE((unpacked & igtl::MessageHeader::UNPACK_BODY) != 0) << header->GetDeviceName();
      if (device == header->GetDeviceName()) return message;
    }
    return {};
  }

 private:
  static igtl::MessageBase::Pointer Made(const std::string& type) {
    if (type == "TRANSFORM") return igtl::TransformMessage::New().GetPointer();
    if (type == "NDARRAY") return igtl::NDArrayMessage::New().GetPointer();
    if (type == "POLYDATA") return igtl::PolyDataMessage::New().GetPointer();
    if (type == "IMAGE") return igtl::ImageMessage::New().GetPointer();
    return {};
  }
  igtl::ClientSocket::Pointer socket_;
};

struct Publishing : testing::Test {
  const Session session = Published();
  Publisher publisher{session};
  Viewer viewer{publisher.port()};
  const ControllerCommand command = BentShaft(session);
};

TEST_F(Publishing, TheTipAndItsCovariance) {
  publisher.Take(command);
  const auto tip = viewer.Next("tip");
  ASSERT_TRUE(tip.IsNotNull());
  igtl::Matrix4x4 T;
  dynamic_cast<igtl::TransformMessage&>(*tip).GetMatrix(T);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(T[i][3], 1e3 * command.estimate.p_RE[i], 1e-3);
    EXPECT_NEAR(T[i][0], command.estimate.d_RE[i], 1e-6);
  }
  const auto covariance = viewer.Next("tip_covariance");
  ASSERT_TRUE(covariance.IsNotNull());
  auto* const array = dynamic_cast<igtl::NDArrayMessage&>(*covariance).GetArray();
  const auto* const values = static_cast<const double*>(array->GetRawArray());
  for (int i = 0; i < 9; ++i)
    EXPECT_DOUBLE_EQ(values[i], 1e6 * command.estimate.p_RE_covariance_m2(i / 3, i % 3));
}

TEST_F(Publishing, TheShaftIsALineFromWristToTip) {
  publisher.Take(command);
  const auto message = viewer.Next("shaft");
  ASSERT_TRUE(message.IsNotNull());
  auto& shaft = dynamic_cast<igtl::PolyDataMessage&>(*message);
  const auto expected = EstimatedShape(command.estimate, command.measurements.p_RW, 40);
  ASSERT_EQ(shaft.GetPoints()->GetNumberOfPoints(), 40);
  ASSERT_EQ(shaft.GetLines()->GetNumberOfCells(), 1u);
  ASSERT_EQ(shaft.GetLines()->GetCellSize(0), 40u);
  std::vector<igtlUint32> line(40);
  shaft.GetLines()->GetCell(0, line.data());
  int k = 0;
  for (const igtlUint32 place : line) {
    igtlFloat32 p[3];
    shaft.GetPoints()->GetPoint(place, p);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(p[i], 1e3 * expected[static_cast<std::size_t>(k)].p_R[i], 1e-3);
    ++k;
  }
}

TEST_F(Publishing, ThePicture) {
  publisher.Take(command);
  ASSERT_TRUE(viewer.Next("wrist").IsNotNull());  // the viewer is known by now
  Image picture(4, 3, 1);
  for (std::size_t i = 0; i < 12; ++i) picture.data[i] = static_cast<std::uint8_t>(7 * i);
  publisher.TakePicture(kTime_ns + 5, picture);
  const auto message = viewer.Next("cam0");
  ASSERT_TRUE(message.IsNotNull());
  auto& image = dynamic_cast<igtl::ImageMessage&>(*message);
  int size[3];
  image.GetDimensions(size);
  EXPECT_EQ(size[0], 4);
  EXPECT_EQ(size[1], 3);
  const auto* const pixels = static_cast<const std::uint8_t*>(image.GetScalarPointer());
  EXPECT_TRUE(std::equal(picture.data.begin(), picture.data.end(), pixels));
}

TEST_F(Publishing, NothingTwiceAndNothingWithoutAWrist) {
  publisher.Take(command);
  ASSERT_TRUE(viewer.Next("wrist").IsNotNull());
  publisher.Take(command);  // the same cycle
  ControllerCommand later = command;
  later.t_ns += 1'000'000;
  later.estimate = ShaftEstimate();  // bad input: no tip, but the wrist
  publisher.Take(later);
  const auto wrist = viewer.Next("wrist");
  ASSERT_TRUE(wrist.IsNotNull());
  unsigned seconds = 0, fraction = 0;
  wrist->GetTimeStamp(&seconds, &fraction);
  EXPECT_NEAR(fraction / 4.294967296, 1e6, 1.0);
}

}  // namespace
}  // namespace flextip::live
