#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A browser of low priority: the control processes come first, as on a robot.
exec nice -n 10 "${HANDSEL_CHROMIUM:-/usr/bin/chromium}" "$@"
