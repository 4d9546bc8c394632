/* Tables of {{ model.name }}, made from its table of variables. */
#include "model.h"

#include <math.h>

static const struct variable variables[] = {
{% for one in rows %}
{% if one is none %}{# a value reference that no variable has #}
    {"", UNUSED, CLOCK, 0, -1, -1, -1, 0, 0, 0, 0.0, 0.0, 0.0, 1.0, ""},
{% elif one == model.time %}{# no place in a record of the kernel, no rate #}
    {"time", REAL, CLOCK, 0, -1, -1, -1, 0, 0, 0, 0.0, -HUGE_VAL, HUGE_VAL, 1.0, ""},
{% else %}
    {{ "{" }}{{ quoted(one.name) }}, {{ one.kind | upper }}, {{ arrays.get(one.causality, "OUTPUTS") }}, {{ model.place(one.name) }},
{% for ending in ("_rate", "_rate_given") %}
     {{ model.place(one.name ~ ending) if one.causality == "input" else -1 }},
{% endfor %}
     {{ discrete.index(one.name) if one.name in discrete else -1 }}, {{ one.late | int }}, {{ (one.causality == "output") | int }}, {{ one.is_tunable | int }},
     {{ number(one.start or 0.0) }}, {{ number(one.ends[0]) }}, {{ number(one.ends[1]) }}, {{ number(small(one)) }},
     {{ quoted(one.allowed if one.causality == "parameter" else "") }}},
{% endif %}
{% endfor %}
};

{% for name, texts in (("messages", model.messages), ("warnings", model.warnings)) if texts %}
{% for status, text in texts.items() %}
static const struct piece {{ name }}_{{ status }}[] = {
{% for before, kind, slot in pieces(text, model) %}
    {{ "{" }}{{ quoted(before) }}, {{ kind }}, {{ slot }}},
{% endfor %}
    {"", LAST_PIECE, 0},
};

{% endfor %}
static const struct message {{ name }}[] = {
{% for status in texts %}
    {{ "{%d, %s_%d}" | format(status, name, status) }},
{% endfor %}
};

{% endfor %}
static const int discrete[] = {
{% for name in discrete %}
    {{ model.place(name) }},
{% else %}{# C has no empty arrays #}
    0,
{% endfor %}
};
static const size_t traced[] = {{ "{%s}" | format(traced | join(", ")) }};

static const struct bound bounds[] = {
{% for one in model.bounds %}
    {{ "{%s, %d, %s}" | format(records[one.record], one.place, number(one.maximum)) }},
{% else %}
    {CONSTANTS, 0, 0.0},
{% endfor %}
};

INTERNAL_OBJECT const struct model model = {
    {{ quoted(model.name) }}, {{ quoted(guid) }}, variables, {{ rows | length }},
    {{ tolerance }}, {{ switch | join(", ") }},
    {{ model.sizes | join(", ") }},
    messages, {{ model.messages | length }}, {{ "warnings" if model.warnings else "NULL" }}, {{ model.warnings | length }},
    discrete, {{ discrete | length }}, traced, {{ traced | length }}, bounds, {{ model.bounds | length }},
};
