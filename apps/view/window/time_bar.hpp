// Slider, play, and where one is.
#pragma once

#include <functional>

#include <QTimer>
#include <QWidget>

class QLabel;
class QSlider;
class QToolButton;

namespace pivnp::view {

class TimeBar : public QWidget {
 public:
  explicit TimeBar(QWidget* parent = nullptr);

  void set_count(int count);
  int count() const { return count_; }
  int at() const;
  void go(int index);            // within what there is
  void step(int by) { go(at() + by); }
  void set_words(const QString& words);
  void toggle_play();
  /// Playing goes on once what was asked for is on the screen.
  void shown() { waiting_ = false; }
  QSlider* slider() const { return slider_; }

  std::function<void(int)> changed;

 private:
  void play_on();

  QSlider* slider_;
  QLabel* words_;
  QToolButton* play_;
  QTimer timer_;
  int count_ = 0;
  bool waiting_ = false;
};

}  // namespace pivnp::view
