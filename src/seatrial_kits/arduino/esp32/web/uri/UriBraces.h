/* Paths with places: "/motor/{}/speed/{}". */
#ifndef URI_BRACES_H
#define URI_BRACES_H

#include "../Uri.h"

class UriBraces : public Uri {
public:
    using Uri::Uri;
    Uri *clone() const override { return new UriBraces(_uri); }

    bool canHandle(const String &asked, std::vector<String> &places) override
    {
        places.clear();
        unsigned at = 0, from = 0;
        for (int brace; (brace = _uri.indexOf("{}", from)) >= 0; from = (unsigned)brace + 2) {
            unsigned size = (unsigned)brace - from;
            if (asked.substring(at, at + size) != _uri.substring(from, (unsigned)brace))
                return false;
            at += size;
            int end = asked.indexOf('/', at);
            places.push_back(asked.substring(at, end < 0 ? asked.length() : (unsigned)end));
            at += places.back().length();
        }
        return asked.substring(at) == _uri.substring(from);
    }
};

#endif
