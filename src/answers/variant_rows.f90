!> The summary of a set with VARY cards: a row for each variant, with its values and what is asked of its motion.
module variant_rows
   use kinds, only: wp, label_length
   use planar, only: in_degrees
   use mechanism, only: mechanism_t, driven_kinds, request_link
   use motion, only: mark_none, diagnostic_t, diagnostic_limit
   use drives, only: new_law, drive_motion, pole_value
   use names, only: drive_name, subject_name
   use independent, only: parts_t
   use deck_variants, only: variation_t, varied_t, values_of_variant
   use set_analysis, only: set_analysis_t
   use set_motion, only: in_set, is_flagged
   use listing_layout, only: layout_t, digits_t, dimension_of, column_text, choose_digits, angle_unit
   use csv, only: marks
   use table, only: table_t, new_table, drive_columns, dotted
   use extremes, only: extreme_t, least, greatest, outward, extreme_words, requests_of, column_of
   use ranges, only: range_t, low, high
   use answers, only: answers_t
   use numerals, only: whole
   use phrases
   implicit none
   private
   public :: summary_t, summary_column_t, cell_t, variant_row_t, new_summary, new_row, note_flag, fill_row
   public :: cell_count, cell_number, cell_word, cell_unbounded, cell_none

   !> What a cell holds.
   enum, bind(c)
      enumerator :: cell_none = 0     !< nothing
      enumerator :: cell_count        !< a whole number
      enumerator :: cell_number       !< a number in the deck's units, of angles in rad
      enumerator :: cell_unbounded    !< there is no bound; the sign of `value` says in which direction
      enumerator :: cell_word         !< a word
   end enum

   type :: cell_t
      integer :: kind = cell_none
      real(wp) :: value = 0.0_wp
      real(wp) :: error = 0.0_wp                    !< what rounding leaves open of `value`
      character(3*label_length + 2) :: word = ''
   end type cell_t

   !> A column: its name in a file, and its form in the listing.
   type :: summary_column_t
      character(80) :: name = ''
      logical :: printed = .false.                  !< it is in the listing too
      character(3*label_length) :: heads(2) = ''    !< the lines over it
      character(3*label_length) :: unit = ''
      logical :: angular = .false.                  !< `value` is in rad
      integer :: decimals = 0, power = 0            !< as in `digits_t`
   end type summary_column_t

   type :: summary_t
      type(summary_column_t), allocatable :: columns(:)
      integer :: numbers = 0                        !< that vary: columns 2 to numbers + 1
      type(table_t) :: extremes                     !< the columns of what EXTREMES asks for
      integer, allocatable :: drives(:)             !< (requests for extremes) the first drive of its mechanism; 0: none
   end type summary_t

   type :: variant_row_t
      integer :: number = 0                         !< of the variant
      type(cell_t), allocatable :: cells(:)         !< (columns)
      character(:), allocatable :: rejected         !< the error for which it is not computed; '' for none
      integer :: solved = 0, flagged = 0            !< instants
      integer :: unproved = 0                       !< instants that are not proved, with their steps, if a card asks
      integer :: mark = mark_none, singularity = 0  !< of the first flagged instant
      real(wp) :: t = 0.0_wp                        !< its time
      type(diagnostic_t) :: limit                   !< the first limit; its kind is 0: none
   end type variant_row_t

contains

   !> The columns of the summary of `m`, whose independent mechanisms are `parts`; `l`: its layout; `v`: its variants.
   function new_summary(m, parts, l, v) result(s)
      type(mechanism_t), intent(in) :: m
      type(parts_t), intent(in) :: parts
      type(layout_t), intent(in) :: l
      type(variation_t), intent(in) :: v
      type(summary_t) :: s
      character(:), allocatable :: drives(:)
      integer :: i

      s%numbers = size(v%numbers)
      drives = drive_columns(m)
      allocate (s%columns(0))
      call add_headed('variant', phrase(say_variant, m%polish), '')
      do i = 1, size(v%numbers)
         call add_column(varied_column(v%numbers(:i)))
      end do
      call add_headed('solved', phrase(say_instants, m%polish), phrase(say_are_solved, m%polish))
      call add_headed('flagged', phrase(say_instants, m%polish), phrase(say_flagged, m%polish))
      call add_column(summary_column_t('flag.t', .true., heads_of(phrase(say_first_flag, m%polish), &
         phrase(say_at_time, m%polish)), m%time_unit, decimals=l%time_decimals, power=l%time_power))
      call add_drive(min(1, size(m%drives)), 'flag', heads_of('', ''))
      call add_column(summary_column_t('flag.mark'))
      call add_column(summary_column_t('limit.t'))
      call add_column(summary_column_t('limit.drive'))
      call add_column(summary_column_t('limit.value'))
      if (m%ranges) call add_ranges()
      if (m%assemblies) call add_headed('assemblies', phrase(say_assemblies, m%polish), '')
      if (m%proves) call add_headed('unproved', phrase(say_instants, m%polish), phrase(say_not_proved, m%polish))
      call add_extremes()

   contains

      !> Adds a column of counts, with two lines over it in the listing.
      subroutine add_headed(name, first, second)
         character(*), intent(in) :: name, first, second

         call add_column(summary_column_t(name, .true., heads_of(first, second)))
      end subroutine add_headed

      !> Two lines over a column. (A constructor of character expressions has wrong bytes by gfortran 12.)
      pure function heads_of(first, second) result(heads)
         character(*), intent(in) :: first, second
         character(3*label_length) :: heads(2)

         heads(1) = first
         heads(2) = second
      end function heads_of

      !> Adds the column `c`.
      subroutine add_column(c)
         type(summary_column_t), intent(in) :: c

         s%columns = [s%columns, c]
      end subroutine add_column

      !> The column of the last of the `numbers`. If earlier ones have its name, a number behind the name counts them.
      function varied_column(numbers) result(c)
         type(varied_t), intent(in) :: numbers(:)
         type(summary_column_t) :: c
         real(wp) :: largest
         integer :: alike

         associate (one => numbers(size(numbers)))
            c%printed = .true.
            c%name = dotted(trim(one%owner)//' '//one%word)
            alike = count(numbers%owner == one%owner .and. numbers%word == one%word)
            if (alike > 1) c%name = trim(c%name)//'.'//whole(alike)
            c%heads = heads_of(one%owner, one%word)
            c%unit = one%unit
            largest = max(abs(one%first), abs(one%last))
            if (allocated(one%list)) largest = maxval(abs(one%list))
            call choose_digits(log10(max(largest, tiny(1.0_wp))), c%decimals, c%power)
            if (.not. largest > 0.0_wp) c%power = 0
         end associate
      end function varied_column

      !> Adds the column of the values of drive number `d` (0: none, the column is empty), whose name begins with
      !> `start`; `heads`: the lines over it, blank where it is in the file alone.
      subroutine add_drive(d, start, heads)
         integer, intent(in) :: d
         character(*), intent(in) :: start, heads(2)
         type(summary_column_t) :: c

         c%name = start//'.drive'
         if (d > 0) then
            c%name = start//'.'//drives(d)
            c%angular = driven_kinds(m%drives(d)%kind) == request_link
            c%printed = any(heads /= '')
            c%heads = heads
            c%unit = merge(angle_unit(m), m%length_unit, c%angular)
            if (d <= size(l%drives)) then
               c%decimals = l%drives(d)%decimals
               c%power = l%drives(d)%power
            end if
         end if
         call add_column(c)
      end subroutine add_drive

      !> Adds the columns of what EXTREMES asks for.
      subroutine add_extremes()
         type(mechanism_t) :: asked
         type(summary_column_t) :: c
         integer, allocatable :: requests(:)
         integer :: i, which
         character(3), parameter :: endings(least:greatest) = ['min', 'max']

         requests = requests_of(m)
         asked = m
         asked%requests = m%requests(requests)
         asked%requests%every = 1
         if (allocated(asked%tolerances)) deallocate (asked%tolerances)
         s%extremes = new_table(asked)
         allocate (s%drives(size(requests)), source=min(1, size(m%drives)))
         do i = 1, merge(0, size(requests), parts%count == 1)
            associate (own => parts%list(parts%part(requests(i)))%drives)
               s%drives(i) = 0
               if (size(own) > 0) s%drives(i) = own(1)
            end associate
         end do
         do i = 1, size(s%extremes%columns)
            associate (column => s%extremes%columns(i))
               do which = least, greatest
                  c = extreme_column(requests(column%request), column%coordinate, column%order, column%angular)
                  c%name = trim(column%name)//'.'//endings(which)
                  c%heads(2) = trim(c%heads(2))//' '//extreme_words(which)
                  call add_column(c)
                  call add_column(summary_column_t(trim(c%name)//'.t'))
                  call add_drive(s%drives(column%request), trim(c%name), heads_of('', ''))
               end do
            end associate
         end do
      end subroutine add_extremes

      !> The column of coordinate `coordinate`, derivative `k`, of request number `i` of `m`.
      function extreme_column(i, coordinate, k, angular) result(c)
         integer, intent(in) :: i, coordinate, k
         logical, intent(in) :: angular
         type(summary_column_t) :: c
         type(digits_t) :: d
         integer :: place

         place = column_of(m, m%requests(i), coordinate)
         associate (kind => m%requests(i)%kind, column => l%column(place, k, m%requests(i)%kind))
            c%printed = .true.
            c%heads = heads_of(subject_name(m, kind, m%requests(i)%subject), column_text(l%names(kind), column))
            c%unit = column_text(l%units(1, kind), column)//column_text(l%units(2, kind), column)
         end associate
         c%angular = angular
         d = l%own(l%part(i))
         c%decimals = d%decimals(dimension_of(place), k)
         c%power = d%power(dimension_of(place), k)
      end function extreme_column

      !> Adds the columns of the ranges of all drives.
      subroutine add_ranges()
         character(:), allocatable :: word
         integer :: d

         word = phrase(say_one_range, m%polish)
         do d = 1, size(m%drives)
            call add_drive(d, 'range.min', heads_of(drive_name(m, m%drives(d)), word//' MIN'))
            call add_drive(d, 'range.max', heads_of(drive_name(m, m%drives(d)), word//' MAX'))
            call add_headed('range.turns.'//trim(drives(d)), drive_name(m, m%drives(d)), &
               phrase(say_whole_turns, m%polish))
         end do
      end subroutine add_ranges
   end function new_summary

   !> The row of variant `n` of `v`, with its values alone.
   function new_row(s, v, n) result(r)
      type(summary_t), intent(in) :: s
      type(variation_t), intent(in) :: v
      integer, intent(in) :: n
      type(variant_row_t) :: r
      real(wp) :: values(s%numbers)
      integer :: i

      r = variant_row_t(number=n, rejected='')
      allocate (r%cells(size(s%columns)))
      r%cells(1) = cell_t(cell_count, real(n, wp))
      values = values_of_variant(v, n)
      do i = 1, size(values)
         r%cells(i + 1) = cell_t(cell_number, values(i))
      end do
   end function new_row

   !> Takes the instant to which `a` has advanced: whether it is flagged, and of the first one why.
   subroutine note_flag(r, a)
      type(variant_row_t), intent(inout) :: r
      type(set_analysis_t), intent(in) :: a
      integer :: c, i

      if (.not. is_flagged(a%now)) then
         r%solved = r%solved + 1
         return
      end if
      r%flagged = r%flagged + 1
      do c = 1, size(a%now%motions)
         associate (q => a%now%motions(c))
            if (r%mark == mark_none .and. q%mark /= mark_none) then
               r%mark = q%mark
               r%singularity = q%singularity
               r%t = q%t
            end if
            if (r%limit%kind /= 0 .or. .not. allocated(q%diagnostics)) cycle
            i = findloc(q%diagnostics%kind, diagnostic_limit, dim=1)
            if (i > 0) r%limit = in_set(q%diagnostics(i), a%now%parts%list(c))
         end associate
      end do
   end subroutine note_flag

   !> Fills the cells of `r`, that of the variant `m`, after its last instant; `asked`: the answers to its cards.
   subroutine fill_row(s, m, asked, r)
      type(summary_t), intent(in) :: s
      type(mechanism_t), intent(in) :: m
      type(answers_t), intent(in) :: asked
      type(variant_row_t), intent(inout) :: r
      integer :: n, i, which

      n = s%numbers + 1
      call next(cell_t(cell_count, real(r%solved, wp)))
      call next(cell_t(cell_count, real(r%flagged, wp)))
      if (r%mark /= mark_none) then
         call next(cell_t(cell_number, r%t))
         call next(drive_cell(m, min(1, size(m%drives)), r%t))
         call next(cell_t(cell_word, word=marks(r%mark)))
      else
         n = n + 3
         if (r%rejected /= '') r%cells(n) = cell_t(cell_word, word=r%rejected(:4))
      end if
      if (r%limit%kind /= 0) then
         r%cells(n + 1) = cell_t(cell_number, r%limit%t)
         if (r%limit%drive > 0) then
            r%cells(n + 2) = cell_t(cell_word, word=drive_name(m, m%drives(r%limit%drive)))
            r%cells(n + 3) = cell_t(cell_number, r%limit%value)
            if (r%limit%is_pole) r%cells(n + 3) = cell_t(cell_unbounded, sign(1.0_wp, r%limit%value))
            if (r%limit%is_angle .and. m%degrees) r%cells(n + 3)%value = in_degrees(r%limit%value)
         end if
      end if
      n = n + 3
      if (r%rejected /= '') return
      if (m%ranges) then
         call take_ranges(asked%ranges, r%cells(n + 1:n + 3*size(m%drives)))
         n = n + 3*size(m%drives)
      end if
      if (m%assemblies) call next(cell_t(merge(cell_none, cell_count, asked%assemblies < 0), &
         real(asked%assemblies, wp)))
      if (m%proves) call next(cell_t(cell_count, real(r%unproved, wp)))
      do i = 1, size(s%extremes%columns)
         associate (c => s%extremes%columns(i))
            do which = least, greatest
               call take_extreme(m, asked%extremes%found(which, c%coordinate, c%order, c%request), which, &
                  s%drives(c%request), r%cells(n + 1:n + 3))
               n = n + 3
            end do
         end associate
      end do

   contains

      !> The next cell.
      subroutine next(cell)
         type(cell_t), intent(in) :: cell

         n = n + 1
         r%cells(n) = cell
      end subroutine next
   end subroutine fill_row

   !> The cells of the extreme `e`: value, time, and the value of drive number `d` there.
   subroutine take_extreme(m, e, which, d, cells)
      type(mechanism_t), intent(in) :: m
      type(extreme_t), intent(in) :: e
      integer, intent(in) :: which, d
      type(cell_t), intent(inout) :: cells(3)

      if (.not. e%exists) return
      cells(1) = cell_t(cell_number, e%value, e%error)
      if (.not. e%has_bound) cells(1) = cell_t(cell_unbounded, outward(which))
      cells(2) = cell_t(cell_number, e%t)
      cells(3) = drive_cell(m, d, e%t)
   end subroutine take_extreme

   !> The value of drive number `d` (0: none) at the time `t`.
   type(cell_t) function drive_cell(m, d, t) result(cell)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: d
      real(wp), intent(in) :: t
      real(wp) :: f(3)

      if (d == 0) return
      cell = cell_t(cell_unbounded, sign(1.0_wp, pole_value(m%drives(d), m%t0)))
      if (abs(t) <= 0.0_wp .and. abs(pole_value(m%drives(d), m%t0)) > 0.0_wp) return
      f = drive_motion(new_law(m%drives(d)), t)
      cell = cell_t(cell_number, f(1))
   end function drive_cell

   !> The cells of all ranges: limits, and the turns after which the motion closes.
   subroutine take_ranges(list, cells)
      type(range_t), intent(in) :: list(:)
      type(cell_t), intent(inout) :: cells(:)
      integer :: i, side

      do i = 1, size(list)
         associate (n => 3*(list(i)%drive - 1))
            do side = low, high
               if (list(i)%has_limit(side)) cells(n + side) = cell_t(cell_number, list(i)%limit(side)%value)
            end do
            cells(n + 3) = cell_t(cell_count, real(merge(list(i)%turns, 0, list(i)%is_all), wp))
         end associate
      end do
   end subroutine take_ranges
end module variant_rows
