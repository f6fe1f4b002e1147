# C tests. One says at its top what it is made of:
#
#   /* LINK: firmware/input/latch.c tests/support/edges.c */   sources, * allowed; without this line
#                                                              a contract or scenario test gets all
#   /* MOCK: hal/include/hal_edge.h */                         headers CMock makes mock_….h of
#   /* CFLAGS: -DLATCH_STEP=hook */                            for the test and what it links
#   /* LDFLAGS: -Wl,--wrap=calloc */                           for linking it

# LINK.tests/unit/test_x, MOCK.…, CFLAGS.… and LDFLAGS.… of every test, read from those comments.
build/tests.mk: $(TESTS) $(FUZZ) scripts/read_test_comments.awk
	@mkdir -p $(@D)
	@awk -f scripts/read_test_comments.awk $(TESTS) $(FUZZ) /dev/null >$@
include build/tests.mk

# $(call parts_of,tests/unit/test_x): what a test links.
sources_of = $(foreach pattern,$(LINK.$1),$(or $(wildcard $(pattern)),$(pattern)))
folder_of  = $(OUT)/$(if $(CFLAGS.$1),private/$1,obj)
whole_sim  = $(if $(filter $(TESTS.unit:.c=),$1),,$(OUT)/libskiplatch_sim.a)
parts_of   = $(if $(LINK.$1),$(patsubst %.c,$(folder_of)/%.o,$(sources_of)),$(whole_sim))
mocks_of   = $(patsubst %.h,build/mocks/mock_%.h,$(notdir $(MOCK.$1)))

MOCKED  := $(sort $(foreach test,$(TESTS:.c=),$(MOCK.$(test))))
# A mock includes the header it was made of without the folder.
CFLAGS.tests   += $(addprefix -I,$(sort $(dir $(MOCKED))))
CFLAGS.foreign += $(addprefix -I,$(sort $(dir $(MOCKED))))
RUNNERS := $(TESTS:%.c=build/runners/%.c)
.PHONY: generated
generated: $(RUNNERS) $(patsubst %.h,build/mocks/mock_%.c,$(notdir $(MOCKED)))
	@:

build/runners/%.c: %.c
	@mkdir -p $(@D)
	@ruby -W0 $(UNITY)/auto/generate_test_runner.rb --use_param_tests=1 $< $@

define mock_rules
build/mocks/mock_$(notdir $(1:.h=)).c build/mocks/mock_$(notdir $1) &: $1 tests/support/cmock.yml
	@mkdir -p $$(@D)
	@ruby -W0 $(CMOCK)/lib/cmock.rb -otests/support/cmock.yml --mock_path=build/mocks $1
endef
$(foreach header,$(MOCKED),$(eval $(call mock_rules,$(header))))

# What speaks and ends for a suite on a board; a Cortex-M needs the port's start-up beside it.
TARGET_GLUE := $(if $(TARGET),$(wildcard tests/support/target_$(FAMILY).c))

# $1: the test without its ending
define test_rules
$(OUT)/obj/$1.o: private TEST_CFLAGS := $(CFLAGS.$1)
$(OUT)/obj/$1.o: | $(mocks_of)
$(OUT)/$1: $(OUT)/obj/$1.o $(OUT)/foreign/runners/$1.o $(mocks_of:build/%.h=$(OUT)/foreign/%.o) \
           $(OUT)/foreign/unity.o $(OUT)/foreign/cmock.o $(parts_of) $(call object_of,$(TARGET_GLUE)) \
           $(if $(LINKER_SCRIPT),$(OUT)/libboard.a $(LINKER_SCRIPTS))
	@mkdir -p $$(@D)
	$(Q)$(CC) $(FLAGS) $$(LDFLAGS) $(LDFLAGS.$1) -fno-lto $$(filter %.o,$$^) $$(filter %.a,$$^) -lm -o $$@
$(OUT)/foreign/runners/$1.o: | $(mocks_of)
$(if $(CFLAGS.$1),$(call private_rules,$1))
endef

# The sources a test compiles for itself, with its own flags.
define private_rules
$(OUT)/private/$1/%.o: %.c $(OUT)/flags/$$$$(call room_of,$$$$*.c) $1.c
	@mkdir -p $$(@D)
	$(SAY) '$(CC) $$<, for $1'
	$(Q)$(CC) $$(call cflags_of,$$<) $(CFLAGS.$1) -MMD -MP -c $$< -o $$@
endef
$(foreach test,$(TESTS:.c=),$(eval $(call test_rules,$(test))))

# $(call under_test,test_hal_x,PORT): what stands between a contract suite and that port.
under_test = $(if $(filter test_hal_pulse,$1),hal/ports/$2/tests/pulse_lines.c,\
               hal/ports/$2/tests/port_under_test.c tests/support/edge_log.c \
               $(wildcard $(foreach folder,$(FAMILY.$2) $(SHARED.$2),\
                   hal/ports/$(folder)/tests/port_under_test.c)))
