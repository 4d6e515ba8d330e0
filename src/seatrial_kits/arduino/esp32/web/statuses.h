/* Status codes of HTTP (RFC 9110) and their texts. */
#ifndef STATUSES_H
#define STATUSES_H

const char *status_text(int code);

#endif
