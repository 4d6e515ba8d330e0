/* Callbacks at intervals. */
#ifndef TICKER_H
#define TICKER_H

#include "Arduino.h"

class Ticker {
public:
    ~Ticker() { detach(); }
    void attach(float seconds, std::function<void()> callback) { begin((uint64_t)(seconds * 1e6f), true, callback); }
    void attach_ms(uint64_t ms, std::function<void()> callback) { begin(ms * 1000, true, callback); }
    void once(float seconds, std::function<void()> callback) { begin((uint64_t)(seconds * 1e6f), false, callback); }
    void once_ms(uint64_t ms, std::function<void()> callback) { begin(ms * 1000, false, callback); }
    template <typename T> void attach(float seconds, void (*callback)(T), T argument) { attach(seconds, [=] { callback(argument); }); }
    template <typename T> void attach_ms(uint64_t ms, void (*callback)(T), T argument) { attach_ms(ms, [=] { callback(argument); }); }
    template <typename T> void once(float seconds, void (*callback)(T), T argument) { once(seconds, [=] { callback(argument); }); }
    template <typename T> void once_ms(uint64_t ms, void (*callback)(T), T argument) { once_ms(ms, [=] { callback(argument); }); }
    bool active() const { return timer_ && esp_timer_is_active(timer_); }

    void detach()
    {
        if (!timer_)
            return;
        esp_timer_stop(timer_);
        esp_timer_delete(timer_);
        timer_ = nullptr;
    }

private:
    void begin(uint64_t us, bool again, std::function<void()> callback)
    {
        detach();
        callback_ = callback;
        esp_timer_create_args_t given = {[](void *one) { ((Ticker *)one)->callback_(); }, this, ESP_TIMER_TASK, "Ticker", false};
        esp_timer_create(&given, &timer_);
        again ? esp_timer_start_periodic(timer_, us) : esp_timer_start_once(timer_, us);
    }

    std::function<void()> callback_;
    esp_timer_handle_t timer_ = nullptr;
};

#endif
