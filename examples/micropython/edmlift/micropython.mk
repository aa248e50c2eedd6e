# For ports that are built by make: USER_C_MODULES is the folder above this one.
EDMLIFT_DIR := $(abspath $(USERMOD_DIR)/../../..)
SRC_USERMOD_C += $(USERMOD_DIR)/modedmlift.c
SRC_USERMOD_LIB_C += $(foreach folder,joints lift network number,$(wildcard $(EDMLIFT_DIR)/lib/$(folder)/*.c))
SRC_USERMOD_LIB_C += $(EDMLIFT_DIR)/lib/models/direct_w16.c
CFLAGS_USERMOD += -I$(EDMLIFT_DIR)/include
