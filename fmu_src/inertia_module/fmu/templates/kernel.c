/* The kernel of {{ model.name }}: made from Python by way of LLVM, an instruction a statement. */
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* no multiplication and addition in one, which rounds once: results would not be those of other processors */
#if defined __clang__ || !defined __GNUC__
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("-ffp-contract=off")
#endif

#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

typedef uint64_t word;

#define ACCESS(Kind, In, Out)                                                                  \
    static inline Out get_##Kind(const char *p) { In v; memcpy(&v, p, sizeof v); return (Out)v; } \
    static inline void put_##Kind(char *p, Out value) { In v = (In)value; memcpy(p, &v, sizeof v); }
ACCESS(double, double, double)
ACCESS(i64, uint64_t, word)
ACCESS(i8, unsigned char, word)
ACCESS(ptr, char *, char *)
#undef ACCESS

{% for name, numbers in tables %}
static const word {{ name }}[] = {{ "{" }}{{ numbers }}};
{% endfor %}

{% for function in functions %}
{{ function.head }};
{% endfor %}

{% for function in functions %}
{{ function.text() }}

{% endfor %}

int64_t KERNEL(int64_t operation, double *p, double *d, double *u, double *x, double *y, double *w, double h)
{
    return (int64_t){{ entry }}((word)operation, (char *)p, (char *)d, (char *)u, (char *)x, (char *)y, (char *)w, h);
}
