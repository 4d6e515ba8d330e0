/* Methods of requests. */
#ifndef HTTP_METHOD_H
#define HTTP_METHOD_H

typedef enum { HTTP_DELETE, HTTP_GET, HTTP_HEAD, HTTP_POST, HTTP_PUT, HTTP_OPTIONS = 6, HTTP_PATCH = 28, HTTP_ANY = 255 } HTTPMethod;

#endif
