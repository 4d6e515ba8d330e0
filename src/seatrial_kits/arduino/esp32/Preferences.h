/* Values by namespace and key that outlast the power: a file each, below nvs/ in the folder of the flash. */
#ifndef PREFERENCES_H
#define PREFERENCES_H

#include "Arduino.h"

class Preferences {
public:
    bool begin(const char *name, bool read_only = false, const char * = nullptr);
    void end() { folder_.clear(); }
    bool clear();
    bool remove(const char *key);
    bool isKey(const char *key);
    size_t freeEntries() { return 500; }
    size_t putBytes(const char *key, const void *value, size_t size);
    size_t getBytes(const char *key, void *to, size_t most);
    size_t getBytesLength(const char *key);
    size_t putString(const char *key, const char *value) { return putBytes(key, value, strlen(value)); }
    size_t putString(const char *key, const String &value) { return putString(key, value.c_str()); }
    String getString(const char *key, const String &otherwise = String());
    size_t getString(const char *key, char *to, size_t most);
#define SKETCH_PREFERENCE(name, type, otherwise_) \
    size_t put##name(const char *key, type value) { return putBytes(key, &value, sizeof value); } \
    type get##name(const char *key, type otherwise = otherwise_) { type value; return getBytes(key, &value, sizeof value) == sizeof value ? value : otherwise; }
    SKETCH_PREFERENCE(Char, int8_t, 0)
    SKETCH_PREFERENCE(UChar, uint8_t, 0)
    SKETCH_PREFERENCE(Short, int16_t, 0)
    SKETCH_PREFERENCE(UShort, uint16_t, 0)
    SKETCH_PREFERENCE(Int, int32_t, 0)
    SKETCH_PREFERENCE(UInt, uint32_t, 0)
    SKETCH_PREFERENCE(Long, int32_t, 0)
    SKETCH_PREFERENCE(ULong, uint32_t, 0)
    SKETCH_PREFERENCE(Long64, int64_t, 0)
    SKETCH_PREFERENCE(ULong64, uint64_t, 0)
    SKETCH_PREFERENCE(Float, float, NAN)
    SKETCH_PREFERENCE(Double, double, NAN)
    SKETCH_PREFERENCE(Bool, bool, false)
#undef SKETCH_PREFERENCE

private:
    std::string file(const char *key) const;
    std::string folder_;
    bool read_only_ = false;
};

#endif
