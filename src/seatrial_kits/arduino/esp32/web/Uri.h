/* A path that a web server answers; those derived from it match others and say what was in their places. */
#ifndef URI_H
#define URI_H

#include <memory>
#include <vector>

#include "Arduino.h"

class Uri {
public:
    Uri(const char *path) : _uri(path) {}
    Uri(const String &path) : _uri(path) {}
    virtual ~Uri() {}
    virtual Uri *clone() const { return new Uri(_uri); }
    virtual void initPathArgs(std::vector<String> &) {}
    virtual bool canHandle(const String &asked, std::vector<String> &) { return _uri == asked; }

protected:
    const String _uri;
};

#endif
