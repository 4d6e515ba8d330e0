/* String, and texts in flash. */
#ifndef WString_h
#define WString_h

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include <string>

#include "board.h"

class __FlashStringHelper;
#define F(text) (reinterpret_cast<const __FlashStringHelper *>(text))

class String {
public:
    String(const char *text = "") : text_(text ? text : "") {}
    String(const __FlashStringHelper *text) : text_(reinterpret_cast<const char *>(text)) {}
    String(const std::string &text) : text_(text) {}
    String(char c) : text_(1, c) {}
    String(unsigned char v, unsigned char base = 10) : String((unsigned long)v, base) {}
    String(short v, unsigned char base = 10) : String(base == 10 ? (long)v : (long)(unsigned short)v, base) {}
    String(unsigned short v, unsigned char base = 10) : String((unsigned long)v, base) {}
    String(int v, unsigned char base = 10) : String((long)v, base) {}
    String(unsigned v, unsigned char base = 10) : String((unsigned long)v, base) {}
    String(long v, unsigned char base = 10);
    String(unsigned long v, unsigned char base = 10);
    String(float v, unsigned char decimals = 2) : String((double)v, decimals) {}
    String(double v, unsigned char decimals = 2);

#ifdef ESP32
    String(long long v, unsigned char base = 10);
    String(unsigned long long v, unsigned char base = 10);
    String(const char *text, unsigned size) : text_(text, size) {}
    String(const uint8_t *text, unsigned size) : text_((const char *)text, size) {}
    bool isEmpty() const { return text_.empty(); }
    void clear() { text_.clear(); }
    bool concat(const char *text, unsigned size) { text_.append(text, size); return true; }
    typedef void (String::*Truth)() const; /* unlike bool, no number */
    operator Truth() const { return &String::there; }
#endif
    bool reserve(unsigned size) { text_.reserve(size); return true; }
    unsigned length() const { return (unsigned)text_.size(); }
    const char *c_str() const { return text_.c_str(); }
    char *begin() { return &text_[0]; }
    char *end() { return begin() + length(); }
    const char *begin() const { return c_str(); }
    const char *end() const { return c_str() + length(); }
    char charAt(unsigned at) const { return at < text_.size() ? text_[at] : 0; }
    void setCharAt(unsigned at, char c) { if (at < text_.size()) text_[at] = c; }
    char operator[](unsigned at) const { return charAt(at); }
    char &operator[](unsigned at) { static char none; return at < text_.size() ? text_[at] : none = 0; }

    template <typename T> bool concat(const T &other) { text_ += String(other).text_; return true; }
    template <typename T> String &operator+=(const T &other) { concat(other); return *this; }
    friend String operator+(const String &a, const String &b) { return a.text_ + b.text_; }
    template <typename T> friend String operator+(const String &a, const T &b) { return a.text_ + String(b).text_; }
    friend String operator+(const char *a, const String &b) { return a + b.text_; }

    sketch_int compareTo(const String &other) const { return (sketch_int)text_.compare(other.text_); }
    bool equals(const String &other) const { return text_ == other.text_; }
    bool equalsIgnoreCase(const String &other) const;
    bool operator==(const String &other) const { return text_ == other.text_; }
    bool operator!=(const String &other) const { return text_ != other.text_; }
    bool operator==(const char *other) const { return text_ == other; }
    bool operator!=(const char *other) const { return text_ != other; }
    bool operator<(const String &other) const { return text_ < other.text_; }
    bool operator>(const String &other) const { return text_ > other.text_; }
    bool operator<=(const String &other) const { return text_ <= other.text_; }
    bool operator>=(const String &other) const { return text_ >= other.text_; }
    bool startsWith(const String &what, unsigned from = 0) const { return text_.compare(from < text_.size() ? from : text_.size(), what.length(), what.text_) == 0; }
    bool endsWith(const String &what) const { return length() >= what.length() && text_.compare(length() - what.length(), std::string::npos, what.text_) == 0; }

    sketch_int indexOf(char c, unsigned from = 0) const { return place(text_.find(c, from)); }
    sketch_int indexOf(const String &what, unsigned from = 0) const { return place(text_.find(what.text_, from)); }
    sketch_int lastIndexOf(char c) const { return place(text_.rfind(c)); }
    sketch_int lastIndexOf(char c, unsigned from) const { return place(text_.rfind(c, from)); }
    sketch_int lastIndexOf(const String &what) const { return place(text_.rfind(what.text_)); }
    String substring(unsigned from) const { return substring(from, length()); }
    String substring(unsigned from, unsigned to) const;

    void replace(char from, char to) { for (char &c : text_) if (c == from) c = to; }
    void replace(const String &from, const String &to);
    void remove(unsigned from, unsigned count = ~0u) { if (from < text_.size()) text_.erase(from, count); }
    void toLowerCase() { for (char &c : text_) c = (char)tolower((unsigned char)c); }
    void toUpperCase() { for (char &c : text_) c = (char)toupper((unsigned char)c); }
    void trim();
    int32_t toInt() const { return (int32_t)atol(c_str()); }
    float toFloat() const { return (float)atof(c_str()); }
    sketch_real toDouble() const { return (sketch_real)atof(c_str()); }
    void toCharArray(char *to, unsigned size, unsigned from = 0) const;
    void getBytes(unsigned char *to, unsigned size, unsigned from = 0) const { toCharArray((char *)to, size, from); }

private:
    void there() const {}
    static sketch_int place(size_t at) { return at == std::string::npos ? -1 : (sketch_int)at; }
    std::string text_;
};

#endif
