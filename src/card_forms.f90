!> Level 2. The kinds of cards: which fields each takes. The deck's table, declared once.
module card_forms
   use kinds, only: label_length
   use letters, only: capitals
   implicit none
   private
   public :: form_t, forms, label_unused, label_needed, label_optional, find_form, nearest_form
   public :: form_title, form_units, form_lang, form_ground, form_link, form_point, form_revolute, form_prism
   public :: form_drive, form_add, form_time, form_at, form_method, form_print, form_branch, form_end, form_star

   !> What a label field of a card is.
   integer, parameter :: label_unused = 0, label_needed = 1, label_optional = 2

   type :: form_t
      character(label_length) :: name = ''
      integer :: labels(3) = label_unused
      integer :: whole = 0           !< the label field that holds a whole number; 0: none
      integer :: reals = 0           !< the first so many real fields are taken
      logical :: once = .false.      !< at most one in a set
      character(78) :: layout = ''   !< what its fields hold, each in its columns
   end type form_t

   integer, parameter :: form_title = 1, form_units = 2, form_lang = 3, form_ground = 4, form_link = 5
   integer, parameter :: form_point = 6, form_revolute = 7, form_prism = 8, form_drive = 9, form_add = 10
   integer, parameter :: form_time = 11, form_at = 12, form_method = 13, form_print = 14, form_branch = 15
   integer, parameter :: form_end = 16
   !> Not in the table: a `*` card continues the card above it.
   integer, parameter :: form_star = 17

   integer, parameter :: u = label_unused, n = label_needed, o = label_optional

   !> A card's form is its place here. TITLE's text is no label; ADD's third real depends on its label A.
   type(form_t), parameter :: forms(16) = [ &
      form_t('TITLE',    [u, u, u], 0, 0, .true., &
         'TITLE   TEXT, COLUMNS 9 TO 80'), &
      form_t('UNITS',    [o, o, o], 0, 0, .true., &
         'UNITS   LENGTH  RAD/DEG TIME'), &
      form_t('LANG',     [n, u, u], 0, 0, .true., &
         'LANG    EN/PL'), &
      form_t('GROUND',   [n, u, u], 0, 3, .false., &
         'GROUND  LINK                    X               Y               PHI'), &
      form_t('LINK',     [n, u, u], 0, 3, .false., &
         'LINK    LINK                    X               Y               PHI'), &
      form_t('POINT',    [n, n, u], 0, 2, .false., &
         'POINT   POINT   LINK            XI              ETA'), &
      form_t('REVOLUTE', [n, n, n], 0, 0, .false., &
         'REVOLUTEPOINT-I POINT-J PAIR'), &
      form_t('PRISM',    [n, n, n], 0, 3, .false., &
         'PRISM   POINT-I POINT-J PAIR    ALPHA           H               BETA'), &
      form_t('DRIVE',    [n, n, o], 0, 3, .false., &
         'DRIVE   KIND    DRIVEN  LINK    VALUE AT 0.0    RATE            ACCELERATION'), &
      form_t('ADD',      [n, u, u], 0, 3, .false., &
         'ADD     KIND                    R1              R2              R3'), &
      form_t('TIME',     [n, u, u], 1, 2, .true., &
         'TIME    STEPS                   T0              T1'), &
      form_t('AT',       [u, u, u], 0, 3, .false., &
         'AT                              T               T               T'), &
      form_t('METHOD',   [n, u, u], 0, 1, .true., &
         'METHOD  METHOD                  TOLERANCE'), &
      form_t('PRINT',    [n, o, o], 3, 0, .false., &
         'PRINT   KIND    NAME    EVERY'), &
      form_t('BRANCH',   [o, u, u], 0, 1, .false., &
         'BRANCH  LINK                    T'), &
      form_t('END',      [u, u, u], 0, 0, .false., &
         'END')]

contains

   !> The form of the card `name`, or 0.
   pure integer function find_form(name) result(form)
      character(*), intent(in) :: name

      do form = size(forms), 1, -1
         if (forms(form)%name == name) return
      end do
   end function find_form

   !> The form whose name is at most two letters away from `name`, and less than half of its own; or 0.
   pure integer function nearest_form(name) result(nearest)
      character(*), intent(in) :: name
      integer :: form, distance, least

      nearest = 0
      least = 3
      do form = 1, size(forms)
         distance = edits(trim(capitals(name)), trim(forms(form)%name))
         if (distance >= least .or. 2*distance > len_trim(forms(form)%name) + 1) cycle
         least = distance
         nearest = form
      end do
   end function nearest_form

   !> Fewest insertions, deletions and replacements of letters that make `b` of `a` (Levenshtein).
   pure integer function edits(a, b)
      character(*), intent(in) :: a, b
      integer :: row(0:len(b)), i, j, corner, above

      row = [(j, j=0, len(b))]
      do i = 1, len(a)
         corner = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, corner + merge(0, 1, a(i:i) == b(j:j)))
            corner = above
         end do
      end do
      edits = row(len(b))
   end function edits
end module card_forms
