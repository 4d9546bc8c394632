/* Values by the types of FMI 3.0. */
#include "fmi3.h"

static double read_boolean(const void *values, size_t n)
{
    return ((const fmi3Boolean *)values)[n];
}

static void write_boolean(void *values, size_t n, double value)
{
    ((fmi3Boolean *)values)[n] = value != 0.0;
}

/* Enumerations have 64 bits. Their values are small whole numbers, or not yet checked. */
static double read_long(const void *values, size_t n)
{
    return (double)((const fmi3Int64 *)values)[n];
}

static void write_long(void *values, size_t n, double value)
{
    fmi3Int32 whole;
    write_integer(&whole, 0, value);
    ((fmi3Int64 *)values)[n] = whole;
}

static const struct type float64 = {"Float64", 1 << REAL, read_real, write_real};
static const struct type int32 = {"Int32", 1 << INTEGER, read_integer, write_integer};
static const struct type int64 = {"Enumeration", 1 << ENUMERATION, read_long, write_long};
static const struct type boolean = {"Boolean", 1 << BOOLEAN, read_boolean, write_boolean};

fmi3Status check_count(struct instance *c, size_t count, size_t value_count)
{
    if (!c)
        return fmi3Error;
    return count == value_count ? fmi3OK
                                : (fmi3Status)report(c, ERROR, "the number of values must be %lu, one per reference (got %lu)",
                                                     (unsigned long)count, (unsigned long)value_count);
}

/* The two functions of a type that some variables have. */
#define ACCESS(Type, type)                                                                                           \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,                     \
                             fmi3##Type values[], size_t value_count)                                                 \
    {                                                                                                                \
        const fmi3Status status = check_count(c, count, value_count);                                                \
        return status == fmi3OK ? (fmi3Status)get_values(c, references, count, values, &type) : status;               \
    }                                                                                                                \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,                     \
                             const fmi3##Type values[], size_t value_count)                                           \
    {                                                                                                                \
        const fmi3Status status = check_count(c, count, value_count);                                                \
        return status == fmi3OK ? (fmi3Status)set_values(c, references, count, values, &type) : status;               \
    }

ACCESS(Float64, float64)
ACCESS(Int32, int32)
ACCESS(Int64, int64)
ACCESS(Boolean, boolean)
