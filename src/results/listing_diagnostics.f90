!> Diagnostics in words: three stars before what concerns the results, three dashes before what is good to know.
module listing_diagnostics
   use kinds, only: wp
   use planar, only: degree
   use mechanism, only: settings_t, mechanism_t, remark_t, remark_small_letters, remark_more
   use motion
   use names, only: drive_name, listed, more
   use numerals, only: whole, rounded, put_fixed, numeral_length
   use text_output, only: output_t, put
   use phrases
   use listing_layout, only: put_folded, angle_unit, choose_time_digits, unit_of
   implicit none
   private
   public :: limit_words, at_limit, full_turn_words, measure, value_digits, put_diagnostics, no_position_words, &
      put_singular, put_closure_error, remarks_text

   !> Digits of the value of a drive at a limit, or as many as a coarser real has; of a closure error or an angle that
   !> is off.
   integer, parameter :: value_digits = merge(10, 6, precision(1.0_wp) >= 10), error_digits = 3
   !> What concerns the results.
   integer, parameter :: of_results(*) = [diagnostic_inconsistent, diagnostic_limit, diagnostic_mobile, &
      diagnostic_long, diagnostic_close, diagnostic_unused, diagnostic_dead_end, diagnostic_idle, diagnostic_repeated]
   !> A closure error below this, in parts of the characteristic length, is rounding: no two computers have the same.
   real(wp), parameter :: min_closure_error = max(1.0e-13_wp, 400.0_wp*epsilon(1.0_wp))

   !> The words of remarks, by their kind.
   type(phrase_t), parameter :: remark_words(remark_small_letters:remark_more) = &
      [say_small_letters, say_title_long, say_title_letters, say_touching, say_link_unused, say_point_unused, &
      say_radians, say_guide, say_jumps, say_drawn_value, say_drawn_offset, say_open, say_off_drawing, &
      say_near_joints, say_more]

contains

   !> A line for each remark about the cards of `m`, joined by new_line('a'); '' if there are none.
   function remarks_text(m) result(text)
      type(mechanism_t), intent(in) :: m
      character(:), allocatable :: text
      integer :: i

      text = ''
      if (.not. allocated(m%remarks)) return
      do i = 1, size(m%remarks)
         if (i > 1) text = text//new_line('a')
         text = text//' --- '//words_of_remark(m%remarks(i), m%polish)
      end do
   end function remarks_text

   !> CARD 7  COLUMN 9: "TIP" and the sentence of remark `r`.
   function words_of_remark(r, polish) result(text)
      type(remark_t), intent(in) :: r
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = trim(phrase(remark_words(r%kind), polish)//' '//r%value)
      if (r%kind == remark_more) then
         text = text//' '//trim(r%text)
         return
      end if
      if (r%text /= '') text = '"'//trim(r%text)//'" '//text
      text = phrase(say_card, polish)//' '//whole(r%card)//'  '//phrase(say_column, polish)//' '//whole(r%column) &
         //': '//text
   end function words_of_remark

   !> A line for each diagnostic of `list` that no mark has told.
   subroutine put_diagnostics(o, m, list)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: list(:)
      integer :: i

      do i = 1, size(list)
         if (list(i)%kind /= diagnostic_beyond) &
            call put_folded(o, merge(' *** ', ' --- ', any(list(i)%kind == of_results)), words_of(m, list(i)))
      end do
   end subroutine put_diagnostics

   !> Why there is no position where `list` has the diagnostics: the limit of motion before it, or none that is known.
   function no_position_words(m, list) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in), optional :: list(:)
      character(:), allocatable :: text
      integer :: i

      text = phrase(say_no_position, m%polish)
      if (.not. present(list)) return
      do i = 1, size(list)
         if (any(list(i)%kind == [diagnostic_limit, diagnostic_beyond])) &
            text = phrase(say_beyond, m%polish)//' '//time(m, list(i)%t)
      end do
   end function no_position_words

   !> The sentence `words` of a singular position, with the links of `r` before its colon.
   subroutine put_singular(o, m, words, r)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      character(*), intent(in) :: words
      type(diagnostic_t), intent(in) :: r
      integer :: colon

      colon = index(words, ':')
      if (all(r%links == 0)) then
         call put(o, ' *** '//words)
      else
         call put_folded(o, ' *** ', words(:colon - 1)//', '//links(m, r)//in_line(m, r, ' ')//words(colon:))
      end if
   end subroutine put_singular

   !> LINKS A, B AT THE LIMIT, COLLINEAR
   function at_limit(m, r) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(:), allocatable :: text

      text = links(m, r)//' '//phrase(say_at_limit, m%polish)//in_line(m, r, ', ')
   end function at_limit

   !> `before` and the words for links in line; '' where those of `r` are not.
   function in_line(m, r, before) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(*), intent(in) :: before
      character(:), allocatable :: text

      text = ''
      if (r%in_line) text = before//phrase(say_in_line, m%polish)
   end function in_line

   !> The sentence of diagnostic `r`.
   function words_of(m, r) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(:), allocatable :: text

      text = ''
      select case (r%kind)
      case (diagnostic_inconsistent)
         text = owner(m, r)//': '//phrase(say_closure_error_of, m%polish)//' '//measure(m, r, error_digits)
      case (diagnostic_limit)
         if (r%is_pole) then
            text = phrase(say_law, m%polish)//' '//owner(m, r)//' '//phrase(say_pole_of_law, m%polish)
         else
            text = owner(m, r)//' = '//measure(m, r, value_digits)
            if (r%links(1) > 0) text = text//', '//at_limit(m, r)
         end if
      case (diagnostic_far_estimate)
         text = links(m, r)//': '//phrase(say_off_by, m%polish)//' '//measure(m, r, error_digits)
      case (diagnostic_second)
         text = links(m, r)//': '//phrase(say_second, m%polish)
      case (diagnostic_begins)
         text = phrase(say_begins, m%polish)
      case (diagnostic_redundant)
         text = phrase(say_redundant, m%polish)//': '//owner(m, r)
         if (r%equations > 1) text = phrase(say_redundant_many, m%polish)//': '//whole(r%equations)//' ' &
            //phrase(say_of_pair, m%polish)//' '//trim(m%pairs(r%pair)%name)
      case (diagnostic_change)
         text = place_of(m, r)//phrase(merge(merge(say_returns_other, say_returns, r%other), &
            merge(say_here, merge(say_other, say_smoothly, r%other), r%here), r%returns), m%polish)
      case (diagnostic_dead_end)
         text = place_of(m, r)//phrase(say_not_found, m%polish)
      case (diagnostic_unused)
         text = 'BRANCH '
         if (r%links(1) > 0) text = text//trim(m%links(r%links(1))%name)//' '
         text = text//phrase(say_branch_from, m%polish)//' '//time(m, r%t)//': ' &
            //phrase(say_no_change, m%polish)
      case (diagnostic_long)
         text = phrase(say_way, m%polish)//' '//time(m, r%t)//' '//phrase(say_too_long, m%polish)
      case (diagnostic_close)
         text = phrase(say_blocked, m%polish)//' '//time(m, r%t)//': '//phrase(say_close, m%polish)
      case (diagnostic_idle)
         text = owner(m, r)//' '//phrase(say_idle, m%polish)
      case (diagnostic_repeated)
         text = owner(m, r)//' '//phrase(say_repeated, m%polish)
      case (diagnostic_method)
         text = phrase(say_method, m%polish)
         if (r%other) text = phrase(say_elsewhere, m%polish)//': '//text
      case (diagnostic_mobile)
         text = links(m, r)//' '//phrase(say_mobile, m%polish)
      end select
   end function words_of

   !> CHANGE POINT AT T = 16.000000 S, LINKS COUPLER, ROCKER:
   function place_of(m, r) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(:), allocatable :: text

      text = phrase(merge(say_singular_at, say_change, r%returns), m%polish)//' '//time(m, r%t)//', '//links(m, r)//': '
   end function place_of

   !> Where a drive is at the limit `r` of its range, and which links are there.
   function limit_words(m, r) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(:), allocatable :: text

      text = measure(m, r, value_digits)
      if (r%links(1) == 0) return
      text = text//'   '//at_limit(m, r)
   end function limit_words

   !> TURNS FULLY, CLOSES AFTER 1 TURN
   function full_turn_words(turns, polish) result(text)
      integer, intent(in) :: turns
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = phrase(say_all, polish)//' '//whole(turns)//' '//phrase(merge(say_turn, say_turns, turns == 1), polish)
   end function full_turn_words

   !> PAIR A, or DRIVE ANGLE B
   function owner(m, r) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(:), allocatable :: text

      text = ''
      if (r%pair > 0) then
         text = phrase(say_pair, m%polish)//' '//trim(m%pairs(r%pair)%name)
      else if (r%drive > 0) then
         text = phrase(say_drive, m%polish)//' '//trim(drive_name(m, m%drives(r%drive)))
      end if
   end function owner

   !> LINKS A, B AND 3 MORE
   function links(m, r) result(text)
      type(mechanism_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      character(:), allocatable :: text
      integer :: n

      n = count(r%links > 0)
      text = phrase(merge(say_link, say_links, n == 1), m%polish)
      if (n > 0) text = text//' '//listed(m%links(r%links(:n))%name, m%polish)
      text = text//more(r%more, m%polish)
   end function links

   !> The diagnostic's value with so many `digits`, and its unit.
   function measure(m, r, digits) result(text)
      class(settings_t), intent(in) :: m
      type(diagnostic_t), intent(in) :: r
      integer, intent(in) :: digits
      character(:), allocatable :: text
      !> Numbers between these have no exponent.
      real(wp), parameter :: smallest = 1.0e-4_wp, largest = 1.0e9_wp

      if (r%is_angle) then
         text = rounded(r%value/merge(degree, 1.0_wp, m%degrees), digits, smallest, largest)//' '//trim(angle_unit(m))
      else
         text = rounded(r%value, digits, smallest, largest)//' '//trim(m%length_unit)
      end if
   end function measure

   !> A time as the tables of `m` have it, with its unit.
   function time(m, t) result(text)
      class(settings_t), intent(in) :: m
      real(wp), intent(in) :: t
      character(:), allocatable :: text
      character(numeral_length) :: field
      integer :: decimals, power

      call choose_time_digits(m, decimals, power)
      call put_fixed(t, decimals, power, field)
      text = trim(adjustl(field))//' '//unit_of(power, trim(m%time_unit))
   end function time

   !> By how much redundant equations differ, `closure_error` in parts of the characteristic length.
   subroutine put_closure_error(o, polish, closure_error)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: polish
      real(wp), intent(in) :: closure_error
      character(20) :: text

      write (text, '(es8.0e2)') max(closure_error, min_closure_error)
      text = adjustl(text)
      if (closure_error < min_closure_error) text = phrase(say_below, polish)//' '//text
      call put(o, ' '//phrase(say_closure_error, polish)//' '//trim(text))
   end subroutine put_closure_error
end module listing_diagnostics
