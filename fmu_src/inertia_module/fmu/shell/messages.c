/* Messages of an instance and the log categories of the host. */
#include "instance.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *const category_names[CATEGORIES] = {
    "logStatusWarning", "logStatusDiscard", "logStatusError", "logSteps", "logAll"};

enum status set_logging(struct instance *c, int on, size_t count, const char *const categories[])
{
    int is_selected[CATEGORIES] = {0};
    if (!c)
        return ERROR;
    if (count > 0 && !categories)
        return report_missing_array(c, "setDebugLogging");
    for (size_t n = 0; n < count; n++) {
        int category = 0;
        while (category < CATEGORIES && (!categories[n] || strcmp(categories[n], category_names[category]) != 0))
            category++;
        if (category == CATEGORIES)
            return report(c, ERROR, "a log category must be logStatusWarning, logStatusDiscard, logStatusError,"
                          " logSteps or logAll (got %s)", categories[n] ? categories[n] : "NULL");
        is_selected[category] = 1;
    }
    for (int n = 0; n < CATEGORIES; n++)
        if (count == 0 || is_selected[n] || is_selected[LOG_ALL])
            c->logged[n] = on;
    return OK;
}

enum status report(struct instance *c, enum status status, const char *format, ...)
{
    const enum category category =
        status == WARNING ? LOG_WARNING : status == DISCARD ? LOG_DISCARD : LOG_ERROR;
    char text[MESSAGE_SIZE];
    va_list arguments;
    if (!c->host.log || !(category == LOG_ERROR || c->logged[category]))
        return status;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    c->host.log(c, status, category_names[category], text);
    return status;
}

enum status report_wrong_phase(struct instance *c, const char *call, const char *allowed)
{
    return report(c, ERROR, "%s is allowed only %s (the instance is %s)", call, allowed, phase_names[phase_of(c)]);
}

enum status report_missing_array(struct instance *c, const char *call)
{
    return report(c, ERROR, "%s requires arrays that are not NULL", call);
}

const char *number_text(char *text, double value)
{
    size_t length = 0;
    if (!is_number(value))
        return "nan";
    if (!is_finite(value))
        return value > 0.0 ? "inf" : "-inf";
    snprintf(text, NUMBER_SIZE, "%.16g", value);
    for (const char *from = text; *from; from++) {
        if ((*from >= '0' && *from <= '9') || *from == '-' || *from == '+' || *from == 'e')
            text[length++] = *from;
        else if (length > 0 && text[length - 1] != '.') /* a locale's decimal separator may have several bytes */
            text[length++] = '.';
    }
    text[length] = '\0';
    return text;
}

static size_t add_text(char *text, size_t length, const char *added)
{
    while (*added && length < MESSAGE_SIZE - 1)
        text[length++] = *added++;
    return length;
}

static size_t add_number(char *text, size_t length, double value)
{
    return add_text(text, length, TEXT_OF(value));
}

/* Write the message of a status to ``text``. */
static void compose(char *text, const struct instance *c, const struct piece *piece, const double *u, double step)
{
    size_t length = 0;
    for (; piece->number != LAST_PIECE; piece++) {
        length = add_text(text, length, piece->text);
        if (piece->number == PARAMETER_NUMBER)
            length = add_number(text, length, c->p[piece->slot]);
        else if (piece->number == INPUT_NUMBER)
            length = add_number(text, length, u[piece->slot]);
        else if (piece->number == STEP_NUMBER)
            length = add_number(text, length, step);
    }
    text[length] = '\0';
}

enum status report_kernel_status(struct instance *c, enum status status, int64_t kernel_status, const double *u,
                                 double step)
{
    char text[MESSAGE_SIZE];
    for (size_t n = 0; n < model.message_count; n++) {
        if (model.messages[n].number != kernel_status)
            continue;
        compose(text, c, model.messages[n].pieces, u, step);
        return report(c, status, "%s", text);
    }
    return report(c, status, "internal error: the kernel returned status %d", (int)kernel_status);
}

void log_warnings(struct instance *c)
{
    char text[MESSAGE_SIZE];
    if (model.warning_count == 0)
        return;
    const int64_t warnings = call_kernel(OPERATION_WARN, c->p, c->d, c->u, c->x, c->y, c->w, 0.0);
    for (size_t n = 0; n < model.warning_count; n++) {
        if (!(warnings & model.warnings[n].number))
            continue;
        compose(text, c, model.warnings[n].pieces, c->u, 0.0);
        report(c, WARNING, "%s", text);
    }
}

void log_step(struct instance *c, double step)
{
    char text[MESSAGE_SIZE];
    size_t length = 0;
    if (!c->logged[LOG_STEPS] || !c->host.log)
        return;
    length = add_text(text, length, "step to t = ");
    length = add_number(text, length, c->head[TIME]);
    length = add_text(text, length, " s, length ");
    length = add_number(text, length, step);
    length = add_text(text, length, " s");
    for (size_t n = 0; n < model.traced_count; n++) {
        const struct variable *variable = &model.variables[model.traced[n]];
        length = add_text(text, length, ", ");
        length = add_text(text, length, variable->name);
        length = add_text(text, length, " = ");
        length = add_number(text, length, c->values[variable->array][variable->slot]);
    }
    text[length] = '\0';
    c->host.log(c, OK, category_names[LOG_STEPS], text);
}
