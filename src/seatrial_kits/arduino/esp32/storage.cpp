/* The flash and a card: Preferences and file systems as files in the folder of the flash. */
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "FFat.h"
#include "LittleFS.h"
#include "Preferences.h"
#include "SD.h"
#include "SPIFFS.h"
#include "machine.h"

namespace disk = std::filesystem;
using machine::charge;

constexpr uint32_t READ = 800, WRITE = 16000; /* 50 us and 1 ms, as flash takes */

fs::FS LittleFS("littlefs"), SPIFFS("spiffs"), FFat("ffat");
fs::SDFS SD("sd");
fs::SDMMCFS SD_MMC("sd");

namespace fs {

struct File::Open {
    FS *system;
    std::string path; /* as the sketch has it */
    disk::path place;
    FILE *file = nullptr; /* null: a folder */
    std::vector<disk::path> entries;
    size_t next = 0;
    ~Open() { if (file) fclose(file); }
};

std::string FS::place(const char *path) const
{
    disk::path whole = disk::path("/") / path; /* nothing outside: '..' ends at the root */
    return std::string(machine::folder()) + "/" + name_ + whole.lexically_normal().string();
}

bool FS::begin(bool, const char *, uint8_t, const char *)
{
    charge(WRITE);
    std::error_code failed;
    disk::create_directories(place(""), failed);
    return *machine::folder() && !failed;
}

bool FS::format() { std::error_code failed; disk::remove_all(place(""), failed); return begin(); }
bool FS::exists(const char *path) { charge(READ); std::error_code failed; return disk::exists(place(path), failed); }
bool FS::remove(const char *path) { charge(WRITE); std::error_code failed; return disk::remove(place(path), failed); }
bool FS::mkdir(const char *path) { charge(WRITE); std::error_code failed; return disk::create_directories(place(path), failed); }

bool FS::rename(const char *from, const char *to)
{
    charge(WRITE);
    std::error_code failed;
    disk::rename(place(from), place(to), failed);
    return !failed;
}

size_t FS::usedBytes()
{
    std::error_code failed;
    uintmax_t used = 0;
    for (const auto &each : disk::recursive_directory_iterator(place(""), failed))
        used += each.is_regular_file() ? each.file_size() : 0;
    return (size_t)used;
}

File FS::open(const char *path, const char *mode, bool create)
{
    charge(READ);
    auto made = std::make_shared<File::Open>();
    made->system = this;
    made->path = path;
    made->place = place(path);
    std::error_code failed;
    if (disk::is_directory(made->place, failed)) {
        for (const auto &each : disk::directory_iterator(made->place, failed))
            made->entries.push_back(each.path());
        std::sort(made->entries.begin(), made->entries.end()); /* the computer's order is none */
    } else {
        if (*mode != 'r' || create)
            disk::create_directories(made->place.parent_path(), failed);
        made->file = fopen(made->place.c_str(), mode);
        if (!made->file)
            return File();
    }
    File file;
    file.open_ = made;
    return file;
}

size_t File::write(const uint8_t *data, size_t size) { charge(16 * (uint32_t)size); return open_ && open_->file ? fwrite(data, 1, size, open_->file) : 0; }
int File::available() { size_t at = position(), all = size(); return at < all ? (int)(all - at) : 0; }
int File::read() { charge(16); return open_ && open_->file ? fgetc(open_->file) : -1; }
void File::flush() { charge(WRITE); if (open_ && open_->file) fflush(open_->file); }
size_t File::read(uint8_t *to, size_t size) { charge(16 * (uint32_t)size); return open_ && open_->file ? fread(to, 1, size, open_->file) : 0; }
size_t File::position() const { return open_ && open_->file ? (size_t)ftell(open_->file) : 0; }
bool File::seek(uint32_t to, SeekMode mode) { return open_ && open_->file && !fseek(open_->file, (long)to, mode == SeekSet ? SEEK_SET : mode == SeekCur ? SEEK_CUR : SEEK_END); }
bool File::isDirectory() const { return open_ && !open_->file; }
const char *File::path() const { return open_ ? open_->path.c_str() : ""; }
void File::rewindDirectory() { if (open_) open_->next = 0; }

int File::peek()
{
    int c = read();
    if (c >= 0)
        ungetc(c, open_->file);
    return c;
}

size_t File::size() const
{
    if (!open_ || !open_->file)
        return 0;
    fflush(open_->file);
    std::error_code failed;
    uintmax_t found = disk::file_size(open_->place, failed);
    return failed ? 0 : (size_t)found;
}

const char *File::name() const
{
    const char *last = strrchr(path(), '/');
    return last ? last + 1 : path();
}

File File::openNextFile(const char *mode)
{
    if (!open_ || open_->next >= open_->entries.size())
        return File();
    disk::path place = open_->entries[open_->next++];
    std::string base = open_->path == "/" ? "" : open_->path;
    return open_->system->open((base + "/" + place.filename().string()).c_str(), mode);
}

} // namespace fs

/* ------------------------------------------------------------------ Preferences */

bool Preferences::begin(const char *name, bool read_only, const char *)
{
    charge(READ);
    if (!*machine::folder() || strlen(name) > 15 || strchr(name, '/'))
        return false;
    std::string place = std::string(machine::folder()) + "/nvs/" + name;
    std::error_code failed;
    if (read_only && !disk::exists(place, failed))
        return false;
    disk::create_directories(place, failed);
    folder_ = place;
    read_only_ = read_only;
    return !failed;
}

/* Keys have 15 characters at most, as on the board; a '/' would be another folder. */
std::string Preferences::file(const char *key) const
{
    if (folder_.empty() || !*key || strlen(key) > 15)
        return "";
    std::string name = key;
    std::replace(name.begin(), name.end(), '/', '%');
    return folder_ + "/" + name;
}

bool Preferences::clear()
{
    charge(WRITE);
    std::error_code failed;
    if (folder_.empty() || read_only_)
        return false;
    disk::remove_all(folder_, failed);
    disk::create_directories(folder_, failed);
    return !failed;
}

bool Preferences::remove(const char *key) { charge(WRITE); std::error_code failed; return !read_only_ && disk::remove(file(key), failed); }
bool Preferences::isKey(const char *key) { charge(READ); std::error_code failed; return disk::exists(file(key), failed); }

size_t Preferences::putBytes(const char *key, const void *value, size_t size)
{
    charge(WRITE);
    std::string place = file(key);
    if (place.empty() || read_only_)
        return 0;
    std::ofstream out(place, std::ios::binary);
    out.write((const char *)value, (std::streamsize)size);
    return out.good() ? size : 0;
}

size_t Preferences::getBytesLength(const char *key)
{
    charge(READ);
    std::error_code failed;
    uintmax_t size = disk::file_size(file(key), failed);
    return failed ? 0 : (size_t)size;
}

size_t Preferences::getBytes(const char *key, void *to, size_t most)
{
    size_t size = getBytesLength(key);
    if (!size || size > most)
        return 0;
    std::ifstream in(file(key), std::ios::binary);
    in.read((char *)to, (std::streamsize)size);
    return in.good() ? size : 0;
}

String Preferences::getString(const char *key, const String &otherwise)
{
    if (!isKey(key))
        return otherwise;
    std::string text(getBytesLength(key), 0);
    getBytes(key, &text[0], text.size());
    return text;
}

size_t Preferences::getString(const char *key, char *to, size_t most)
{
    String text = getString(key);
    if (!isKey(key) || text.length() + 1 > most)
        return 0;
    memcpy(to, text.c_str(), text.length() + 1);
    return text.length() + 1;
}
