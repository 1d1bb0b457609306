; Configuration bits. HSPLL: crystal x4. Brown-out at 4.33 V (the core needs 4.2 V at 29.5 MHz).
; Watchdog 4 ms x 16 = 64 ms. A stack overflow or underflow resets.

        include "board.inc"

        config  OSC = HSPLL, FCMEN = OFF, IESO = OFF
        config  PWRT = ON, BOREN = SBORDIS, BORV = 1
        config  WDT = ON, WDTPS = 16
        config  MCLRE = ON, LPT1OSC = OFF, PBADEN = OFF, CCP2MX = PORTC
        config  STVREN = ON, LVP = OFF, XINST = OFF, DEBUG = OFF
        config  CP0 = OFF, CP1 = OFF, CP2 = OFF, CP3 = OFF, CPB = OFF, CPD = OFF
        config  WRT0 = OFF, WRT1 = OFF, WRT2 = OFF, WRT3 = OFF, WRTB = OFF, WRTC = OFF, WRTD = OFF
        config  EBTR0 = OFF, EBTR1 = OFF, EBTR2 = OFF, EBTR3 = OFF, EBTRB = OFF

        end
