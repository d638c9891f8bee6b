// What the tests of this folder share: a folder that is gone afterwards, small pictures, and the message of an error.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "pivnp/core/error.hpp"

namespace pivnp::image::test {

namespace fs = std::filesystem;

class Scratch : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("pivnp_image_" + std::to_string(::getpid()) + "_" + info->test_suite_name() +
                                           "_" + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path at(const std::string& name) const { return folder_ / name; }
  /// A picture whose grey values tell `seed`, column and row apart.
  static cv::Mat picture(int seed, int width = 40, int height = 30, int type = CV_8U) {
    cv::Mat image(height, width, type);
    const int top = CV_MAT_DEPTH(type) == CV_16U ? 65535 : 255;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c)
        for (int k = 0; k < image.channels(); ++k) {
          const int value = (seed * 7919 + r * 131 + c * 17 + k * 53 + r * c) % (top + 1);
          if (top == 255) image.ptr<std::uint8_t>(r)[c * image.channels() + k] = std::uint8_t(value);
          else image.ptr<std::uint16_t>(r)[c * image.channels() + k] = std::uint16_t(value);
        }
    return image;
  }
  void write(const std::string& name, const cv::Mat& image) const {
    fs::create_directories(at(name).parent_path());
    ASSERT_TRUE(cv::imwrite(at(name).string(), image)) << name;
  }
  static std::string bytes(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void put(const fs::path& file, const std::string& bytes) {
    fs::remove(file);  // a file that is overwritten in place may be flushed to the disk at once
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
  }
  void truncate(const std::string& name, double share) const {
    fs::resize_file(at(name), std::uintmax_t(share * double(fs::file_size(at(name)))));
  }

  fs::path folder_;
};

/// The message of the InputError that `action` throws; a failure if it throws none, or one of several lines.
template <class Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const InputError& e) {
    const std::string message = e.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

}  // namespace pivnp::image::test
