/* How functions of an interface are called and made visible: with the prefix that a static build defines, else plainly. */

#if defined(_WIN32)
#define TN_EXPORT __declspec(dllexport)
#else
#define TN_EXPORT __attribute__((visibility("default")))
#endif

#define TN_JOIN_(a, b) a##b
#define TN_JOIN(a, b) TN_JOIN_(a, b)
#if defined(FMI2_FUNCTION_PREFIX)
#define FMI2(name) TN_JOIN(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#define FMI2(name) fmi2##name
#endif
#if defined(FMI3_FUNCTION_PREFIX)
#define FMI3(name) TN_JOIN(FMI3_FUNCTION_PREFIX, fmi3##name)
#else
#define FMI3(name) fmi3##name
#endif

#define TN_DO(call) \
    do { \
        if ((call) != TN_OK) \
            return (int)TN_ERROR; \
    } while (0)
