/* Paths by a regular expression; its groups are the places. */
#ifndef URI_REGEX_H
#define URI_REGEX_H

#include <regex>

#include "../Uri.h"

class UriRegex : public Uri {
public:
    using Uri::Uri;
    Uri *clone() const override { return new UriRegex(_uri); }

    bool canHandle(const String &asked, std::vector<String> &places) override
    {
        std::cmatch found;
        if (!std::regex_match(asked.c_str(), found, std::regex(_uri.c_str())))
            return false;
        places.clear();
        for (size_t each = 1; each < found.size(); each++)
            places.push_back(String(found[each].str().c_str()));
        return true;
    }
};

#endif
