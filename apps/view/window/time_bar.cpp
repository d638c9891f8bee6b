#include "apps/view/window/time_bar.hpp"

#include <algorithm>

#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QToolButton>

namespace pivnp::view {

TimeBar::TimeBar(QWidget* parent) : QWidget(parent), slider_(new QSlider(Qt::Horizontal)), words_(new QLabel), play_(new QToolButton) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(6, 2, 6, 2);
  play_->setAutoRaise(true);
  play_->setText("▶");
  play_->setFixedWidth(30);
  play_->setToolTip("Play (Space)");
  play_->setFocusPolicy(Qt::NoFocus);
  words_->setMinimumWidth(210);
  words_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  row->addWidget(play_);
  row->addWidget(slider_, 1);
  row->addWidget(words_);
  slider_->setObjectName("slider");
  slider_->setEnabled(false);
  play_->setEnabled(false);
  connect(slider_, &QSlider::valueChanged, this, [this](int value) {
    waiting_ = true;
    if (changed) changed(value);
  });
  connect(play_, &QToolButton::clicked, this, [this] { toggle_play(); });
  timer_.setInterval(40);
  connect(&timer_, &QTimer::timeout, this, [this] { play_on(); });
}

void TimeBar::set_count(int count) {
  count_ = count;
  if (timer_.isActive()) toggle_play();
  const QSignalBlocker quiet(slider_);
  slider_->setRange(0, std::max(0, count - 1));
  slider_->setPageStep(std::max(1, count / 10));
  slider_->setEnabled(count > 1);
  play_->setEnabled(count > 1);
  if (count == 0) words_->clear();
}

int TimeBar::at() const { return slider_->value(); }

void TimeBar::go(int index) { slider_->setValue(std::clamp(index, 0, std::max(0, count_ - 1))); }

void TimeBar::set_words(const QString& words) {
  words_->setText(words_->fontMetrics().elidedText(words, Qt::ElideMiddle, 300));
  words_->setToolTip(words);
}

void TimeBar::toggle_play() {
  if (timer_.isActive()) {
    timer_.stop();
  } else if (count_ > 1) {
    waiting_ = false;
    timer_.start();
  }
  play_->setText(timer_.isActive() ? "❚❚" : "▶");
}

void TimeBar::play_on() {
  if (waiting_) return;
  slider_->setValue(at() + 1 < count_ ? at() + 1 : 0);
}

}  // namespace pivnp::view
